import csv
import json

import numpy as np
import pytest

from lqd_search.runs.metrics import Metrics
from lqd_search.runs.run_folder import RunFolder
from lqd_search.runs.run_folder_error import RunFolderError
from lqd_search.runs.stored_outcomes import OutcomeError

RESULTS = ("archive.npz", "outcomes.npz", "metrics.csv", "summary.json")


def files_of(folder):
    return {str(p.relative_to(folder.path)) for p in folder.path.rglob("*") if p.is_file()}


def results(folder):
    with (folder.path / "metrics.csv").open(newline="") as file:
        rows = [{**row, "seconds": ""} for row in csv.DictReader(file)]
    summary = {**folder.summary(), "seconds": 0.0}
    npz = [(folder.path / name).read_bytes() for name in ("archive.npz", "outcomes.npz")]
    return rows, summary, npz


@pytest.mark.parametrize("method", ["ours", "random"])
def test_a_finished_run_holds_its_results_and_nothing_else(new_run, method):
    run = new_run(method=method)
    state = run.record()

    grids = {f"pictures/grid.{name}.png" for name in run.folder.archive().grids}
    pictures = {"pictures/curves.png", "pictures/ground_truth.png", *grids}
    functionals = {"functionals/success.py", "functionals/functionals.json"}
    assert files_of(run.folder) == {*RESULTS, "config.json", *functionals, *pictures}
    assert len(grids) == (2 if method == "ours" else 0)
    assert run.folder.finished
    summary, outcomes = run.folder.summary(), run.folder.outcomes()
    assert summary["evaluations"] == 640
    assert summary["seconds"] == state.seconds
    assert summary["success_archive_size"] == run.folder.archive().fields["expert"].sum()
    found = summary["outcomes"]
    assert found["both"] == (outcomes["success"] & outcomes["expert"]).sum() > 0
    assert found["inferred_only"] == (outcomes["success"] & ~outcomes["expert"]).sum() > 0
    assert found["expert_only"] == 0


@pytest.mark.parametrize("method", ["ours", "random"])
def test_a_run_that_is_stopped_after_every_generation_ends_like_one_that_is_not(new_run, method):
    whole, stopped = new_run("whole", method=method), new_run("stopped", method=method)
    whole.record()
    for generation in range(1, 21):
        stopped.record(generations=generation)
        assert not stopped.folder.finished
    stopped.record()

    assert results(stopped.folder) == results(whole.folder)
    assert files_of(stopped.folder) == files_of(whole.folder)


def test_without_grids_there_is_no_coverage(new_run):
    run = new_run(method="random")
    run.record()

    with (run.folder.path / "metrics.csv").open(newline="") as file:
        assert {row["coverage"] for row in csv.DictReader(file)} == {""}
    assert run.folder.summary()["waiting_descriptors"] == []


def test_descriptors_wait_for_a_grid_also_where_the_archive_is_empty(new_run):
    run = new_run(minimum=100_000)
    run.record()

    assert run.folder.summary()["archive_size"] == 0
    assert run.folder.summary()["waiting_descriptors"] == ["end.place", "end.motion"]


def test_the_metrics_can_be_watched_while_they_grow(new_run):
    run, seen = new_run(), []

    def watch(metrics: Metrics):
        text = (run.folder.path / "metrics.csv").read_bytes()
        assert text.endswith(b"\r\n")
        rows = list(csv.DictReader(text.decode().splitlines()))
        seen.append([row["generation"] for row in rows])
        assert rows[-1] == {
            name: "" if value is None else str(value) for name, value in vars(metrics).items()
        }

    run.record(on_generation=watch)

    assert seen == [[str(i) for i in range(1, n + 1)] for n in range(1, 21)]


def test_a_checkpoint_does_not_grow_beyond_the_archive(new_run):
    run, sizes = new_run(evaluations=3_200), {}
    path = run.folder.path / "checkpoint"

    def note(metrics):
        sizes[metrics.generation] = (path.stat().st_size, metrics.archive_size)

    state = run.record(generations=90, on_generation=note)

    # Of what the exploration keeps nothing is left after it, and then the grids are soon full.
    assert state.method.chosen is not None
    assert sizes[10][0] > sizes[30][0]
    (early, elites), (late, elites_then) = sizes[45], sizes[90]
    assert elites_then - elites <= 2
    # Only the figures of each generation are added.
    assert late - early < 45 * 250


def test_a_missing_segment_of_the_outcomes_is_one_sentence(new_run):
    run = new_run()
    run.record(generations=3)
    (run.folder.path / "checkpoint-outcomes" / "000002.npz").unlink()

    with pytest.raises(OutcomeError, match=r"outcomes in \S+000002\.npz, but they cannot be read"):
        run.record()


@pytest.mark.parametrize("name", ["archive.npz", "pictures/curves.png", "summary.json"])
def test_results_that_cannot_be_written_can_be_written_later(new_run, name):
    run, other = new_run("run"), new_run("other")
    other.record()
    blocked = run.folder.path / name
    blocked.mkdir()

    if name == "summary.json":
        assert run.folder.finished
        run.folder.state.save(run.state)
    with pytest.raises(RunFolderError, match=r"^Expected to write \S+, but that failed \(Is a dir"):
        run.record()
    blocked.rmdir()
    assert len(RunFolder(run.folder.path).state.load().metrics) == 20
    run.record()

    assert results(run.folder) == results(other.folder)
    assert files_of(run.folder) == files_of(other.folder)


def test_the_summary_is_json_of_plain_numbers(new_run):
    run = new_run()
    run.record()

    summary = json.loads((run.folder.path / "summary.json").read_text())
    assert summary == run.folder.summary()
    assert not any(isinstance(value, np.generic) for value in summary.values())
