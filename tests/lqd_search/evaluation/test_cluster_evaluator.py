import dataclasses
import os
import re
import signal
import sys
import threading
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import cloudpickle
import numpy as np
import pytest

from lqd_envs import SolutionSpace, get_task, rollout
from lqd_search import FunctionalEvaluator, Functionals, Values, ValuesError
from lqd_search.evaluation import cluster_evaluator
from lqd_search.evaluation.cluster import ClusterError, open_cluster
from lqd_search.evaluation.cluster_evaluator import ClusterEvaluator, evaluate_chunk
from lqd_search.evaluation.functional_calls import RefusedValueError
from lqd_search.evaluation.installation import installation
from lqd_search.evaluation.mesh_judge import MeshJudge
from lqd_search.evaluation.motion_evaluator import MotionEvaluator
from lqd_search.evaluation.refusals import Refusals
from lqd_search.evaluation.values import StoppedFunction

SOLUTIONS = np.random.default_rng(0).random((50, 3))
MARKED = 31
"""The solution in whose chunk an accident happens."""


def kill(_folder):
    os.kill(os.getpid(), signal.SIGKILL)


def hang(folder):
    pause = threading.Event()
    while not (folder / "released").exists():
        pause.wait(0.05)


def fail(_folder):
    raise ValuesError("Expected no solution like this one.")


@dataclass(frozen=True)
class Toy:
    """A recipe of an evaluator that takes no time, and of an accident."""

    folder: Path
    accident: Callable[[Path], None] | None = None
    times: int = 1000

    def __call__(self):
        with (self.folder / "built").open("a") as file:
            file.write(f"{os.getpid()}\n")
        return self.evaluate

    def evaluate(self, solutions):
        if self.accident and (solutions == SOLUTIONS[MARKED]).all(axis=1).any():
            happened = len(list(self.folder.glob("accident-*")))
            if happened < self.times:
                (self.folder / f"accident-{happened}").touch()
                self.accident(self.folder)
        return toy_values(solutions)


def toy_values(solutions):
    x, y, z = solutions.T
    refusals = Refusals()
    for i in np.flatnonzero(z > 0.5):
        refusals.note(int(i), "fitness", "near", RefusedValueError(f"is {round(x[i], 1)}"))
        refusals.note(int(i), "quantity", "place", RefusedValueError("is high"))
    valid = y < 0.9
    return Values(
        valid=valid,
        success=valid & (x > 0.5),
        fitness={"near": np.where(z > 0.5, np.nan, np.sin(x)), "away": np.exp(y)},
        measures={"end.place": np.where((x > 0.3)[:, None], solutions[:, :2], np.nan)},
        refusals=refusals.listed(),
        passive={"digest": z.view(np.uint64)},
        perceived={"contact": solutions.astype(np.float32)},
    )


@dataclass(frozen=True)
class Unknown:
    """A recipe that nothing but this process can unpickle."""

    def __reduce__(self):
        return __import__, ("lqd_search.no_such_module",)


@dataclass(frozen=True)
class FaucetRecipe:
    """A recipe of a real evaluator, with functionals that are this module's."""

    def __call__(self):
        task = get_task("LQD/Faucet-v0")
        space = SolutionSpace()
        motions = rollout(task, space.sample(8, rng=np.random.default_rng(0)), threads=1)
        example = motions.infos(int(np.flatnonzero(motions.valid)[0]))[0]
        functionals = Functionals(
            success=lambda infos: infos[-1]["gripper_position"][2] > 0.1,
            fitness={"height": lambda info: info["gripper_position"][2]},
            timestamps={"end": lambda infos: infos[-1], "number": lambda infos: len(infos)},
            quantities={"place": lambda info: info["gripper_position"]},
        )
        judge = MeshJudge(FunctionalEvaluator(functionals, examples=[example]))
        return MotionEvaluator(task, judge, 1)


def bits(values):
    columns = []
    for field in dataclasses.fields(Values):
        column = getattr(values, field.name)
        if field.name not in ("refusals", "stopped"):
            for name, array in (column if isinstance(column, dict) else {"": column}).items():
                columns.append((field.name, name, array.dtype, array.shape, array.tobytes()))
    return columns, values.refusals, values.stopped


@pytest.fixture(scope="module", autouse=True)
def _pickled_by_value():
    # Pytest imports this module in a way that no worker can.
    module = sys.modules[__name__]
    cloudpickle.register_pickle_by_value(module)
    yield
    cloudpickle.unregister_pickle_by_value(module)


@pytest.fixture(scope="module")
def client():
    with open_cluster("local:2") as client:
        yield client


@pytest.mark.parametrize("chunk", [1, 7, 50, 64])
def test_values_are_those_of_a_local_evaluation(client, tmp_path, chunk):
    evaluate = ClusterEvaluator(client, Toy(tmp_path), chunk=chunk)
    assert bits(evaluate(SOLUTIONS)) == bits(toy_values(SOLUTIONS))


def test_a_batch_may_be_empty(client, tmp_path):
    values = ClusterEvaluator(client, Toy(tmp_path))(SOLUTIONS[:0])
    assert bits(values) == bits(toy_values(SOLUTIONS[:0]))


def test_a_chunk_holds_a_solution(client):
    with pytest.raises(ClusterError, match="at least one solution, but got 0"):
        ClusterEvaluator(client, Toy(Path()), chunk=0)


def test_a_worker_builds_its_evaluator_once(client, tmp_path):
    evaluate = ClusterEvaluator(client, Toy(tmp_path), chunk=5)
    evaluate(SOLUTIONS)
    evaluate(SOLUTIONS)
    builders = (tmp_path / "built").read_text().split()
    assert 1 <= len(builders) <= 2
    assert len(set(builders)) == len(builders)
    assert str(os.getpid()) not in builders


def test_an_error_of_the_evaluation_is_passed_on(client, tmp_path):
    evaluate = ClusterEvaluator(client, Toy(tmp_path, fail), chunk=8)
    with pytest.raises(ValuesError, match=r"^Expected no solution like this one\.$"):
        evaluate(SOLUTIONS)
    assert len(list(tmp_path.glob("accident-*"))) == 1


def test_a_recipe_that_a_worker_cannot_unpickle_is_an_error(client):
    with pytest.raises(ModuleNotFoundError, match="no_such_module"):
        ClusterEvaluator(client, Unknown())(SOLUTIONS)


def test_real_motions_have_the_same_values_on_a_cluster(client):
    solutions = SolutionSpace().sample(40, rng=np.random.default_rng(1))
    here = FaucetRecipe()()(solutions)
    assert here.valid.any()
    assert here.refusals
    there = ClusterEvaluator(client, FaucetRecipe(), chunk=15)(solutions)
    assert bits(there) == bits(here)


def test_a_chunk_whose_worker_dies_is_evaluated_again(client, tmp_path, capfd):
    evaluate = ClusterEvaluator(client, Toy(tmp_path, kill, times=1), chunk=8)
    assert bits(evaluate(SOLUTIONS)) == bits(toy_values(SOLUTIONS))
    assert (tmp_path / "accident-0").exists()
    assert capfd.readouterr().err == ""


def install(name, version):
    """Let this process be one where something else is installed."""
    installed = {**installation(), name: version}
    cluster_evaluator.installation = lambda: installed


def test_a_worker_that_comes_later_with_something_else_installed_is_refused(tmp_path):
    with open_cluster("local:1") as client:
        evaluate = ClusterEvaluator(client, Toy(tmp_path), chunk=1)
        (first,) = client.nthreads()
        assert bits(evaluate(SOLUTIONS)) == bits(toy_values(SOLUTIONS))

        client.cluster.scale(2)
        client.wait_for_workers(2)
        (late,) = client.nthreads().keys() - {first}
        here = installation()["mujoco"]
        for name, version, message in [
            ("mujoco", "3.0.0", f"to have mujoco {here} as here, but it has 3.0.0; install the"),
            ("lqd_envs", "0" * 64, "to run the sources of lqd_envs that run here, but it runs"),
        ]:
            client.run(install, name, version, workers=[late])
            expected = re.escape(f"Expected worker {late} {message}")
            with pytest.raises(ClusterError, match=f"^{expected}"):
                evaluate(SOLUTIONS)

        pids = client.run(os.getpid)
        assert (tmp_path / "built").read_text().split() == [str(pids[first])]


@pytest.mark.slow
def test_a_worker_that_hangs_is_restarted(client, tmp_path):
    recipe = Toy(tmp_path, hang, times=1)
    evaluate = ClusterEvaluator(client, recipe, chunk=8, patience=2.0)
    assert bits(evaluate(SOLUTIONS)) == bits(toy_values(SOLUTIONS))
    assert (tmp_path / "accident-0").exists()
    assert not (tmp_path / "released").exists()


def test_a_chunk_that_kills_its_workers_is_given_up(client, tmp_path, monkeypatch):
    # However few of them a scheduler allows, `retries` are made.
    monkeypatch.setattr(client.cluster.scheduler, "allowed_failures", 0)
    evaluate = ClusterEvaluator(client, Toy(tmp_path, kill), chunk=8, retries=1)
    with pytest.raises(ClusterError, match=r"solutions 24 to 31 .* lost their worker 2 times"):
        evaluate(SOLUTIONS)
    assert len(list(tmp_path.glob("accident-*"))) == 2


@dataclass(frozen=True)
class Stopping:
    """A recipe of an evaluator that stops a function in its second batch, and from then on."""

    def __call__(self):
        batches = []

        def evaluate(solutions):
            batches.append(solutions)
            stopped = (StoppedFunction("near", "fitness", "was stopped"),) * (len(batches) > 1)
            return dataclasses.replace(toy_values(solutions), stopped=stopped)

        return evaluate


@pytest.mark.parametrize("without_nannies", [1], indirect=True)
def test_an_evaluator_that_stopped_a_function_is_made_anew(without_nannies):
    arguments = cloudpickle.dumps(Stopping()), SOLUTIONS[:8], installation()
    parts = [
        without_nannies.submit(evaluate_chunk, *arguments, pure=False).result() for _ in range(5)
    ]
    assert [len(part.stopped) for part in parts] == [0, 1, 0, 1, 0]


@pytest.fixture
def without_nannies(request, tmp_path):
    from distributed import Client, LocalCluster

    with (
        LocalCluster(
            n_workers=request.param,
            threads_per_worker=1,
            processes=False,
            protocol="tcp://",
            dashboard_address="127.0.0.1:0",
        ) as cluster,
        Client(cluster, timeout=1, set_as_default=False) as client,
    ):
        yield client
        (tmp_path / "released").touch()


@pytest.mark.parametrize("without_nannies", [2], indirect=True)
def test_a_worker_that_hangs_and_has_no_nanny_is_avoided(without_nannies, tmp_path):
    recipe = Toy(tmp_path, hang, times=1)
    # Long enough that the other worker is not taken for one that hangs where the machine is busy.
    evaluate = ClusterEvaluator(without_nannies, recipe, chunk=8, patience=3.0)
    for _ in range(2):
        assert bits(evaluate(SOLUTIONS)) == bits(toy_values(SOLUTIONS))
    assert (tmp_path / "accident-0").exists()


@pytest.mark.parametrize("without_nannies", [1], indirect=True)
def test_when_all_workers_hang_the_batch_is_given_up(without_nannies, tmp_path):
    evaluate = ClusterEvaluator(without_nannies, Toy(tmp_path, hang), patience=0.3)
    with pytest.raises(ClusterError, match="all 1 of the cluster hang"):
        evaluate(SOLUTIONS)


@pytest.mark.parametrize("without_nannies", [2], indirect=True)
def test_a_chunk_that_always_hangs_is_given_up(without_nannies, tmp_path):
    recipe = Toy(tmp_path, hang)
    evaluate = ClusterEvaluator(without_nannies, recipe, chunk=8, patience=0.3, retries=1)
    with pytest.raises(ClusterError, match=r"24 to 31 .* 2 times nothing came back for 0\.3"):
        evaluate(SOLUTIONS)


@pytest.mark.parametrize("without_nannies", [0], indirect=True)
def test_a_cluster_without_workers_is_an_error(without_nannies, tmp_path):
    evaluate = ClusterEvaluator(without_nannies, Toy(tmp_path), patience=0.3)
    with pytest.raises(ClusterError, match=r"for 0\.3 seconds there was none; start some"):
        evaluate(SOLUTIONS)


@pytest.mark.parametrize("without_nannies", [0], indirect=True)
def test_losing_the_scheduler_is_an_error(without_nannies, tmp_path):
    def close_once_it_is_asked():
        while not cluster.scheduler.tasks:
            pause.wait(0.05)
        cluster.close()

    cluster, pause = without_nannies.cluster, threading.Event()
    evaluate = ClusterEvaluator(without_nannies, Toy(tmp_path))
    closer = threading.Thread(target=close_once_it_is_asked)
    closer.start()
    with pytest.raises(ClusterError, match="connection to it is lost"):
        evaluate(SOLUTIONS)
    closer.join()
    with pytest.raises(ClusterError, match="connection to it is lost"):
        evaluate(SOLUTIONS)
