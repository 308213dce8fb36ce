import logging
import sys
import threading
from contextlib import contextmanager
from operator import add

import pytest

from lqd_search.evaluation import cluster
from lqd_search.evaluation.cluster import ClusterError, open_cluster
from lqd_search.evaluation.installation import installation


@contextmanager
def running(*, n_workers):
    """The address of a scheduler whose workers are threads of this process."""
    from distributed import LocalCluster

    with LocalCluster(
        n_workers=n_workers,
        threads_per_worker=1,
        processes=False,
        protocol="tcp://",
        dashboard_address="127.0.0.1:0",
    ) as local:
        yield local.scheduler_address


@pytest.fixture
def impatient(monkeypatch):
    monkeypatch.setattr(cluster, "_CONNECT_SECONDS", 0.5)


@pytest.mark.parametrize(
    "address",
    ["", "local", "local:0", "local:-1", "local:two", "tcp://host", "host:8786", "tls://host:1"],
)
def test_addresses_of_another_form_are_refused(address):
    with (
        pytest.raises(ClusterError, match=rf"'tcp://host:port' .*'local:N'.* but got '{address}'"),
        open_cluster(address),
    ):
        pass


def test_a_running_scheduler_is_connected_to_quietly():
    with running(n_workers=1) as address:
        logger = logging.getLogger("distributed.client")
        level = logger.level
        with open_cluster(address) as client:
            assert client.submit(add, 1, 2).result() == 3
            assert logger.level == logging.ERROR
        assert client.status == "closed"
        assert logger.level == level


@pytest.mark.usefixtures("impatient")
def test_nothing_at_the_address_is_an_error():
    with (
        pytest.raises(ClusterError, match=r"scheduler at tcp://127\.0\.0\.1:9, but nothing.*start"),
        open_cluster("tcp://127.0.0.1:9"),
    ):
        pass


@pytest.mark.usefixtures("impatient")
def test_a_scheduler_without_workers_is_an_error():
    with (
        running(n_workers=0) as address,
        pytest.raises(ClusterError, match=f"`dask worker {address}`"),
        open_cluster(address),
    ):
        pass


def elsewhere(monkeypatch, name, *, here, there):
    """Let a function of the module give another answer in the threads of workers than here."""

    def answer():
        return here if threading.current_thread() is threading.main_thread() else there

    monkeypatch.setattr(cluster, name, answer)


def check_refused(message):
    """Check that a cluster with one worker is refused."""
    with (
        running(n_workers=1) as address,
        pytest.raises(ClusterError, match=message),
        open_cluster(address),
    ):
        pass


def test_workers_with_other_versions_are_refused(monkeypatch):
    here, there = {"mujoco": "4.0.0", "numpy": "2.4.6"}, {"mujoco": "4.0.0", "numpy": "2.3.0"}
    elsewhere(monkeypatch, "installation", here=here, there=there)
    check_refused(r"have numpy 2\.4\.6 as here, but it has 2\.3\.0; inst")


def test_workers_on_another_checkout_are_refused(monkeypatch):
    here = installation()
    there = {**here, "lqd_search": "0123456789abcdef" * 4}
    elsewhere(monkeypatch, "installation", here=here, there=there)
    check_refused(
        r"^Expected worker tcp://\S+ to run the sources of lqd_search that run here, but "
        rf"it runs others \(SHA-256 0123456789ab instead of {here['lqd_search'][:12]}\); "
        "install the same commit"
    )


@pytest.mark.parametrize("more", ["here", "there"])
def test_a_package_that_only_one_of_them_compares_is_a_difference(monkeypatch, more):
    installations = {"here": {"numpy": "2.4.6"}, "there": {"numpy": "2.4.6"}}
    installations[more]["jax"] = "0.9.1"
    elsewhere(monkeypatch, "installation", **installations)
    versions = [installations[place].get("jax", "none") for place in ("here", "there")]
    check_refused("have jax {} as here, but it has {};".format(*versions))


def test_workers_with_another_processor_are_noted_and_used(monkeypatch, caplog):
    elsewhere(monkeypatch, "processor", here="x86_64 One", there="x86_64 Another")
    with running(n_workers=1) as address, open_cluster(address) as client:
        (worker,) = client.nthreads()
        assert client.submit(add, 1, 2).result() == 3
    (record,) = (r for r in caplog.records if r.name == cluster.__name__)
    assert (record.levelname, record.getMessage()) == (
        "WARNING",
        f"note: worker {worker} computes on x86_64 Another and this machine on x86_64 One; its "
        "values may differ in their last bits",
    )


def test_workers_that_cannot_say_their_versions_are_refused(monkeypatch):
    def installed():
        raise ModuleNotFoundError("No module named 'lqd_search'")

    monkeypatch.setattr(cluster, "installation", installed)
    check_refused(r"ModuleNotFoundError: No module .*; install lqd-envs")


def test_a_missing_package_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with (
        pytest.raises(ClusterError, match=r"distributed is not .*`pip install '\.\[cluster\]'"),
        open_cluster("local:1"),
    ):
        pass
