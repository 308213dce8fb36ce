"""The variants of `ours`, on made-up motions, and a variant's run that is stopped and goes on."""

import contextlib
import json
import subprocess
from dataclasses import dataclass, replace

import numpy as np
import pytest

from benchmarks.tables import ablation_run
from benchmarks.tables.ablation_run import ablation_command, run_variant
from benchmarks.tables.cell import Cell
from benchmarks.tables.cell_figures import CellError
from benchmarks.tables.cell_process import run_command
from benchmarks.tables.run_figures import read_run
from benchmarks.tables.steered_run import Steering, steered_by_recording
from benchmarks.tables.subset_evaluator import SubsetEvaluator
from benchmarks.tables.variants import VARIANTS
from lqd_envs import SolutionSpace, get_task
from lqd_search import METHODS, Setting, Values, search
from lqd_search.cli.checked_functionals import CheckedFunctionals
from lqd_search.evaluation.values import StoppedFunction
from lqd_search.methods.exploration_budget import ExplorationBudget
from lqd_search.runs.run_folder import RunFolder

TASK = get_task("LQD/Faucet-v0")
MESH = {"start.place": 2, "start.tilt": 3, "end.place": 2, "end.tilt": 3}
EVALUATIONS, BATCH = 160, 8


@dataclass
class Judged:
    """Made-up values of solutions; it is a judge and its evaluator in one."""

    fitness_names = ("flat", "near", "far")
    descriptors = MESH
    dropped = ()

    @property
    def judge(self):
        return self

    def __call__(self, solutions):
        n = len(solutions)
        x = solutions[:, 0]
        valid = solutions[:, 1] < 0.8
        success = valid & (x > 0.5)
        measures = {name: np.array(solutions[:, 2 : 2 + d]) for name, d in MESH.items()}
        for block in measures.values():
            block[~valid] = np.nan
        fitness = {"flat": np.zeros(n), "near": x, "far": -x}
        return Values(
            valid=valid,
            success=success,
            fitness={name: np.where(valid, f, np.nan) for name, f in fitness.items()},
            measures=measures,
            passive={
                "expert": success & (x > 0.6),
                "ground_truth": np.where(valid, np.abs(x), np.nan)[:, None],
                "digest": np.arange(n, dtype=np.uint64),
                "verdict": np.where(valid, 0, 1).astype(np.uint8),
            },
        )


def setting(seed=3, **changes):
    return Setting(
        **{
            "task": TASK,
            "judge": Judged(),
            "evaluations": EVALUATIONS,
            "batch_size": BATCH,
            "rng": np.random.default_rng(seed),
        }
        | changes
    )


class Failing(Judged):
    """None succeeds, and their measures are few, so that many failures meet in the same cells."""

    def __call__(self, solutions):
        values = super().__call__(solutions)
        for block in values.measures.values():
            np.sign(block, out=block)
        return replace(values, success=np.zeros(len(solutions), dtype=bool))


def run(variant, seed=3, *, judged=Judged):
    method = variant.method(setting(seed))
    search(method, SubsetEvaluator(judged(), variant.choose(tuple(MESH))))
    return method


@pytest.mark.parametrize(
    ("name", "kept"),
    [
        ("ours", tuple(MESH)),
        ("one_timestamp", ("start.place", "start.tilt")),
        ("one_quantity", ("start.place", "end.place")),
        ("one_grid", ("start.place",)),
        ("first_fitness", tuple(MESH)),
        ("coin", tuple(MESH)),
    ],
)
def test_each_variant_has_its_grids_and_as_many_cells_in_all(name, kept):
    method = run(VARIANTS[name])

    specs = method.archive.specs
    assert tuple(specs) == kept
    assert sum(spec.cells for spec in specs.values()) == pytest.approx(40_000, rel=0.1)


def test_the_variant_that_changes_nothing_is_ours():
    ours = METHODS["ours"].build(setting())
    search(ours, Judged())

    output, expected = run(VARIANTS["ours"]).output(), ours.output()

    assert output.keys() == expected.keys()
    for name, column in expected.items():
        np.testing.assert_array_equal(output[name], column)


def test_the_coin_is_that_of_the_command_line():
    ours = METHODS["ours"].build(setting(failure_competition="coin"))
    search(ours, Failing())

    solutions = run(VARIANTS["coin"], judged=Failing).output()["solution"]

    np.testing.assert_array_equal(solutions, ours.output()["solution"])
    by_fitness = run(VARIANTS["ours"], judged=Failing).output()["solution"]
    assert not np.array_equal(solutions, by_fitness)


def test_without_exploration_the_first_fitness_has_all_evaluations():
    method = run(VARIANTS["first_fitness"])

    assert (method.evaluations, method.exploration) == (EVALUATIONS, {})
    assert (method.output()["objective"] == 0.0).all()


def test_without_exploration_ranges_are_learned_again_when_it_would_have_ended():
    sizes = {"evaluations": 800, "batch_size": BATCH}
    method, grids = VARIANTS["first_fitness"].method(setting(**sizes)), {}

    def observe(_):
        grids.setdefault(str(method.archive.specs), method.evaluations)

    search(method, Judged(), observe=observe)

    begun, *again = list(grids.values())[-2:]
    assert begun < ExplorationBudget(**sizes, runs=3).exploration
    assert again == [ExplorationBudget(**sizes, runs=3).exploration]


def test_measures_that_are_left_out_are_the_only_difference():
    solutions = np.random.default_rng(0).normal(size=(20, 9))

    values = SubsetEvaluator(Judged(), ("end.tilt",))(solutions)

    whole = Judged()(solutions)
    assert tuple(values.measures) == ("end.tilt",)
    np.testing.assert_array_equal(values.measures["end.tilt"], whole.measures["end.tilt"])
    np.testing.assert_array_equal(values.success, whole.success)
    assert values.passive.keys() == whole.passive.keys()


def test_a_recording_steers_by_its_whole_mesh():
    solutions = SolutionSpace().sample(12, rng=np.random.default_rng(0))
    stopped = StoppedFunction("success", "success", "took too long")

    with steered_by_recording(TASK.id, sample=1) as steering:
        names = tuple(steering.here.judge.descriptors)
        values = steering.evaluate(())(solutions)
        refused = steering.evaluate((stopped,))(solutions)

    assert len(names) == 16
    assert names[0].partition(".")[0] == names[3].partition(".")[0]
    assert tuple(values.measures) == names
    assert len(values.fitness) == 3
    assert 0 < values.valid.sum() < 12
    (refusal,) = refused.refusals
    assert (refusal.reason, refusal.count) == ("took too long", values.valid.sum())


@pytest.fixture
def made_up(monkeypatch):
    """Let the runs of variants be steered by made-up values; return where to set an evaluator."""
    evaluators = [Judged()]

    @contextlib.contextmanager
    def steered(task_id, *, sample):
        assert (task_id, sample) == (TASK.id, 2)
        functionals = CheckedFunctionals((), {}, model="a model", provenance="Made up.")
        yield Steering(TASK, functionals, evaluators[0], lambda _stopped: evaluators[0])

    monkeypatch.setattr(ablation_run, "steered_by_recording", steered)
    return evaluators


@pytest.mark.parametrize("name", ["one_timestamp", "first_fitness"])
def test_a_run_of_a_variant_that_was_stopped_ends_like_one_that_was_not(name, made_up, tmp_path):
    cell = Cell.of("faucet", name, 7)

    class Stopping(Judged):
        left = 9

        def __call__(self, solutions):
            Stopping.left -= 1
            if not Stopping.left:
                raise KeyboardInterrupt
            return super().__call__(solutions)

    run_variant(cell, tmp_path / "whole", evaluations=EVALUATIONS, batch_size=BATCH)
    made_up[0] = Stopping()
    with pytest.raises(KeyboardInterrupt):
        run_variant(cell, tmp_path / "stopped", evaluations=EVALUATIONS, batch_size=BATCH)
    made_up[0] = Judged()
    assert not RunFolder(tmp_path / "stopped").finished
    run_variant(cell, tmp_path / "stopped", evaluations=EVALUATIONS, batch_size=BATCH)

    figures = [
        read_run(tmp_path / one, cell=cell, steering="mesh", machine="", commit="")
        for one in ("whole", "stopped")
    ]
    assert figures[0].curve == figures[1].curve
    assert figures[0].success_archive_size > 0
    archives = [(tmp_path / one / "archive.npz").read_bytes() for one in ("whole", "stopped")]
    assert archives[0] == archives[1]


@pytest.mark.usefixtures("made_up")
def test_a_run_of_a_variant_that_is_finished_is_not_run_again(tmp_path):
    cell = Cell.of("faucet", "one_grid", 7)
    run_variant(cell, tmp_path / "run", evaluations=EVALUATIONS, batch_size=BATCH)
    before = (tmp_path / "run" / "archive.npz").read_bytes()

    with pytest.raises(CellError, match="that can go on, but it is finished; delete it to run it"):
        run_variant(cell, tmp_path / "run", evaluations=EVALUATIONS, batch_size=BATCH)
    assert (tmp_path / "run" / "archive.npz").read_bytes() == before


@pytest.mark.usefixtures("made_up")
def test_a_run_of_a_variant_does_not_go_on_with_other_functionals(tmp_path):
    cell, run = Cell.of("faucet", "one_grid", 7), tmp_path / "run"
    run_variant(cell, run, evaluations=EVALUATIONS, batch_size=BATCH)
    (run / "summary.json").unlink()
    config = json.loads((run / "config.json").read_text())
    (run / "config.json").write_text(json.dumps(config | {"functionals": "0" * 16}))

    with pytest.raises(CellError, match="with the functionals of the recording, but it has others"):
        run_variant(cell, run, evaluations=EVALUATIONS, batch_size=BATCH)


@pytest.mark.slow
def test_ours_is_the_same_run_among_the_ablations_and_in_the_tables(tmp_path):
    cell = Cell.of("faucet", "ours", 3)
    size = {"evaluations": 320, "batch_size": 8}
    commands = {"tables": run_command(**size), "ablations": ablation_command(**size)}

    for name, command in commands.items():
        subprocess.run(command(cell, tmp_path / name), check=True, capture_output=True)

    for file in ("archive.npz", "outcomes.npz"):
        one, other = ((tmp_path / name / file).read_bytes() for name in commands)
        assert one == other


def test_the_command_names_the_cell_and_its_folder(tmp_path):
    command = ablation_command(evaluations=320, batch_size=8)

    words = command(Cell("drawer", "one_grid", 2, 4), tmp_path / "cell")

    assert " ".join(words[1:]) == (
        f"-m benchmarks.tables.ablation_run {tmp_path / 'cell'} --task drawer --variant one_grid "
        "--seed 2 --sample 4 --evaluations 320 --batch-size 8"
    )
