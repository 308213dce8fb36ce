"""`lqd run --workers`: a whole run on a cluster, to the bytes that it has without one."""

import os
import shutil
import signal
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import cloudpickle
import pytest

from lqd_search.cli import unfinished_run
from lqd_search.evaluation import cluster_evaluator
from lqd_search.evaluation.cluster_evaluator import ClusterEvaluator
from lqd_search.evaluation.installation import installation
from lqd_search.evaluation.motion_evaluator import MotionEvaluator
from lqd_search.runs.stored_archive import StoredArchive


@dataclass(frozen=True)
class Killing:
    """A recipe whose evaluator kills its process, once on all workers, in the midst of a run."""

    recipe: Callable[[], MotionEvaluator]
    folder: Path

    def __call__(self):
        evaluate, calls = self.recipe(), []

        def evaluate_or_die(solutions):
            (self.folder / f"evaluator-{os.getpid()}").touch()
            calls.append(solutions)
            if len(calls) == 5 and self.is_first():
                os.kill(os.getpid(), signal.SIGKILL)
            return evaluate(solutions)

        return evaluate_or_die

    def is_first(self):
        try:
            (self.folder / "killed").touch(exist_ok=False)
        except FileExistsError:
            return False
        return True


@pytest.fixture
def accident(tmp_path, monkeypatch):
    """Let a worker be killed in the midst of a run, and chunks be small; return where it shows."""
    folder = tmp_path / "accident"
    folder.mkdir()

    def spread(client, recipe):
        return ClusterEvaluator(client, Killing(recipe, folder), chunk=10)

    monkeypatch.setattr(unfinished_run, "ClusterEvaluator", spread)
    # Pytest imports this module in a way that no worker can.
    module = sys.modules[__name__]
    cloudpickle.register_pickle_by_value(module)
    yield folder
    cloudpickle.unregister_pickle_by_value(module)


@pytest.fixture
def copy(stopped, tmp_path):
    """Return a copy of the folder of a run that was stopped after three generations."""
    return Path(shutil.copytree(stopped[0], tmp_path / "copy"))


def results(folder):
    return [(folder / name).read_bytes() for name in ("archive.npz", "outcomes.npz")]


def metrics(folder):
    """The rows of `metrics.csv` without their last column, the seconds."""
    lines = (folder / "metrics.csv").read_text().splitlines()
    return [line.rpartition(",")[0] for line in lines]


def refuse_to_evaluate(*_):
    raise AssertionError("something was evaluated in this process")


@pytest.mark.slow
def test_a_run_on_workers_ends_like_one_without(run, run_again, call, tmp_path, monkeypatch):
    monkeypatch.setattr(MotionEvaluator, "__call__", refuse_to_evaluate)
    status, _, err = call(*run_again, "--out", tmp_path / "there", "--workers", "local:2")
    assert status == 0, err

    assert len(StoredArchive.load(run[0] / "archive.npz")) > 100
    assert results(tmp_path / "there") == results(run[0])
    assert metrics(tmp_path / "there") == metrics(run[0])


@pytest.mark.slow
def test_a_run_goes_on_on_workers_of_which_one_is_killed(run, copy, call, accident):
    status, _, err = call("run", "--resume", copy, "--workers", "local:2")

    assert status == 0, err
    assert (accident / "killed").exists()
    evaluators = {path.name for path in accident.glob("evaluator-*")}
    # Two, and the one that came for the one that was killed, if it came before the end.
    assert 2 <= len(evaluators) <= 3
    assert f"evaluator-{os.getpid()}" not in evaluators
    assert results(copy) == results(run[0])
    assert metrics(copy) == metrics(run[0])


def test_a_run_whose_workers_have_other_versions_stops_and_can_go_on(copy, call, monkeypatch):
    before = (copy / "checkpoint").read_bytes()
    here = installation()
    # What a chunk says to be installed here is not what the worker has.
    monkeypatch.setattr(cluster_evaluator, "installation", lambda: {**here, "numpy": "1.2.3"})
    status, out, err = call("run", "--resume", copy, "--workers", "local:1")

    assert (status, out) == (2, "")
    sentence = err.splitlines()[-1]
    assert sentence.startswith("lqd: Expected worker tcp://127.0.0.1:")
    assert f" to have numpy 1.2.3 as here, but it has {here['numpy']}; install the" in sentence
    assert "Traceback" not in err
    assert (copy / "checkpoint").read_bytes() == before
