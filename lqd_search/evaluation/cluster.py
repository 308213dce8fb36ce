"""Connecting to the processes, here or on other machines, that evaluations are spread over."""

import logging
import re
import signal
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from multiprocessing import resource_tracker
from typing import TYPE_CHECKING, Any

from lqd_envs.errors import LQDError
from lqd_search.evaluation.installation import OWN_PACKAGES, installation, processor

if TYPE_CHECKING:
    from distributed import Client

_LOCAL = re.compile(r"local:([1-9][0-9]*)")
_REMOTE = re.compile(r"tcp://[^\s/]+:[0-9]+")
_CONNECT_SECONDS = 10
_RESTART_PATIENCE = "1 day"
_LOG = logging.getLogger(__name__)
_LOGGERS = ("distributed", "distributed.client", "distributed.gc")


class ClusterError(LQDError):
    """The cluster that evaluations are spread over cannot be used, or no longer."""


def import_distributed() -> Any:
    """Return the module `distributed`, which is only needed where a cluster is.

    Raises:
        ClusterError: It is not installed.
    """
    try:
        import distributed
    except ImportError as error:
        raise ClusterError(
            "Expected the packages of the extra `cluster` to evaluate on a cluster, but "
            f"{error.name} is not installed; run `pip install '.[cluster]'` in a clone of lqd-envs."
        ) from error
    return distributed


@contextmanager
def open_cluster(address: str) -> Iterator["Client"]:
    """Connect to a Dask cluster for the length of a `with` block.

    Every worker that is there must have the versions, and of this project's packages the sources,
    that are installed here, since a result may depend on them; a `ClusterEvaluator` asks the same
    of those that come later. A worker with another processor is noted in the log and used. Inside
    the block, Dask logs errors only.

    Args:
        address: `"tcp://host:port"`, the address of a running scheduler, or `"local:N"` for N
            processes on this machine that live as long as the block.

    Yields:
        The connection, to be handed to a `ClusterEvaluator`.

    Raises:
        ClusterError: The address has another form, nothing answers there, there is no worker, a
            worker has other versions or sources, or `distributed` is not installed.
    """
    local = _LOCAL.fullmatch(address)
    if not local and not _REMOTE.fullmatch(address):
        raise ClusterError(
            "Expected a cluster's address as 'tcp://host:port' for a running Dask scheduler or "
            f"'local:N' for N processes on this machine, but got {address!r}; write one of these."
        )
    distributed = import_distributed()
    with ExitStack() as stack:
        stack.enter_context(_quiet())
        scheduler = address
        if local:
            scheduler = stack.enter_context(_local_cluster(distributed, int(local[1])))
        client = stack.enter_context(_connection(distributed, scheduler, address=address))
        _check_workers(client, address)
        yield client


@contextmanager
def _quiet() -> Iterator[None]:
    levels = {name: logging.getLogger(name).level for name in _LOGGERS}
    for name in _LOGGERS:
        logging.getLogger(name).setLevel(logging.ERROR)
    try:
        yield
    finally:
        for name, level in levels.items():
            logging.getLogger(name).setLevel(level)


@contextmanager
def _local_cluster(distributed: Any, n: int) -> Iterator[Any]:
    import dask

    # After 15 seconds without a worker Dask would stop its nanny, which may still be starting it
    # again: on a busy machine that takes longer.
    patient = dask.config.set({"distributed.deploy.lost-worker-timeout": _RESTART_PATIENCE})
    try:
        with _sigint_for_this_thread_only():
            cluster = distributed.LocalCluster(
                n_workers=n,
                threads_per_worker=1,
                processes=True,
                host="127.0.0.1",
                # The scheduler always serves HTTP; by default on all interfaces.
                dashboard_address="127.0.0.1:0",
                scheduler_kwargs={"dashboard": False},
                memory_limit=None,
                silence_logs=logging.ERROR,
                # Loaded before a worker reports for work, so that its first chunk is as fast as
                # the others.
                preload=["lqd_search.evaluation.cluster_evaluator"],
            )
    except (OSError, RuntimeError) as error:
        raise ClusterError(
            f"Expected {n} local workers to start, but they did not: {error}; see their output."
        ) from error
    with patient, cluster:
        yield cluster


@contextmanager
def _sigint_for_this_thread_only() -> Iterator[None]:
    # Threads and processes inherit the mask of the thread that starts them, also those that Dask
    # starts later from its own thread: Ctrl-C reaches the caller alone, who closes the cluster.
    resource_tracker.ensure_running()  # Starting it later would unblock the signal.
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def _connection(distributed: Any, scheduler: Any, *, address: str) -> Iterator["Client"]:
    try:
        client = distributed.Client(scheduler, timeout=_CONNECT_SECONDS, set_as_default=False)
    except (OSError, ValueError) as error:
        raise ClusterError(
            f"Expected a Dask scheduler at {address}, but nothing answered within "
            f"{_CONNECT_SECONDS} seconds; start one with `dask scheduler`, or correct the address."
        ) from error
    with client:
        yield client


def _check_workers(client: Any, address: str) -> None:
    try:
        client.wait_for_workers(1, timeout=_CONNECT_SECONDS)
        answers = client.run(_introduce, on_error="return")
    except OSError as error:
        raise ClusterError(
            f"Expected a worker at the scheduler {address}, but none came within "
            f"{_CONNECT_SECONDS} seconds; start some with `dask worker {address}`."
        ) from error
    for worker, answer in answers.items():
        if isinstance(answer, Exception):
            raise ClusterError(
                f"Expected worker {worker} to say which versions it has, but it raised "
                f"{type(answer).__name__}: {answer}; install lqd-envs with its extra `cluster` "
                "there."
            )
        installed, chip = answer
        check_installation(worker, installed, expected=installation())
        _note_processor(worker, chip)


def _introduce() -> tuple[Mapping[str, str], str]:
    return installation(), processor()


def check_installation(
    worker: str, found: Mapping[str, str], *, expected: Mapping[str, str]
) -> None:
    """Refuse a worker that has another installation than the process that uses it.

    Args:
        worker: Its address.
        found: Its `installation()`.
        expected: That of the process that uses it.

    Raises:
        ClusterError: They differ.
    """
    for name in {**expected, **found}:
        pair = expected.get(name, "none"), found.get(name, "none")
        if pair[0] != pair[1]:
            raise ClusterError(_difference(worker, name, *pair))


def _difference(worker: str, name: str, expected: str, found: str) -> str:
    if name in OWN_PACKAGES:
        return (
            f"Expected worker {worker} to run the sources of {name} that run here, but it runs "
            f"others (SHA-256 {found[:12]} instead of {expected[:12]}); install the same commit of "
            "lqd-envs on both and restart the worker, since results depend on it."
        )
    return (
        f"Expected worker {worker} to have {name} {expected} as here, but it has {found}; install "
        "the same versions on both, since results depend on them."
    )


def _note_processor(worker: str, found: str) -> None:
    here = processor()
    if found != here:
        _LOG.warning(
            "note: worker %s computes on %s and this machine on %s; its values may differ in their "
            "last bits",
            worker,
            found,
            here,
        )
