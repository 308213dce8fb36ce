"""Running cells: with a real run that is killed and goes on, and with stand-ins for what fails."""

import csv
import io
import json
import shutil
import sys

import numpy as np
import pytest
from click.testing import CliRunner
from rich.console import Console

from benchmarks.tables import campaign
from benchmarks.tables.campaign import Campaign
from benchmarks.tables.campaign_progress import CampaignProgress
from benchmarks.tables.cell import Cell
from benchmarks.tables.cell_figures import CellError
from benchmarks.tables.cell_process import run_command, spent
from benchmarks.tables.cell_store import CellStore
from benchmarks.tables.machine import describe_commit
from benchmarks.tables.run_figures import read_run
from lqd_search.cli.main import lqd
from lqd_search.runs import run_recorder
from lqd_search.runs.run_folder import RunFolder

EVALUATIONS, BATCH = 96, 8
CELL = Cell.of("faucet", "handcrafted", 6)


def ignore(_):
    pass


def rows(folder):
    with (folder / "metrics.csv").open(newline="") as file:
        return list(csv.DictReader(file))


@pytest.fixture(scope="session")
def killed(tmp_path_factory):
    """Return the store of a cell whose benchmark was stopped, its rows then, and the figures."""
    store = CellStore(tmp_path_factory.mktemp("tables"), EVALUATIONS, BATCH)
    command = run_command(evaluations=EVALUATIONS, batch_size=BATCH)
    runs = Campaign(store, command=command, jobs=2)
    folder = store.run_folder(CELL)

    def stop(evaluations):
        if evaluations:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        runs.run([CELL], on_work=stop, on_cell=ignore)
    # Nothing runs on: the cell can be claimed, and a last row may only be half written.
    with store.claim(CELL) as lock:
        assert lock is not None
    before = rows(folder)[: len(RunFolder(folder).state.load().metrics)]
    kept_before = store.load([CELL])
    kept = []
    outcome = runs.run([CELL], on_work=ignore, on_cell=kept.append)
    return store, before, kept_before, kept, outcome


@pytest.fixture(scope="session")
def finished(tmp_path_factory):
    """Return the folder of a run of the cell that nobody stopped, made in this process."""
    folder = tmp_path_factory.mktemp("tables") / "run"
    command = run_command(evaluations=EVALUATIONS, batch_size=BATCH)(CELL, folder)
    assert command[1:3] == ("-m", "lqd_search")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(run_recorder, "draw_heat_map", lambda *_, **__: b"a picture")
        CliRunner().invoke(lqd, command[3:], catch_exceptions=False)
    return folder


@pytest.mark.slow
def test_a_cell_that_was_killed_goes_on_where_it_was(killed):
    store, before, kept_before, kept, outcome = killed

    assert kept_before == {}
    assert (outcome.failed, outcome.elsewhere) == ({}, [])
    assert store.load([CELL]) == {CELL: kept[0]}
    after = rows(store.run_folder(CELL))
    assert 0 < len(before) < len(after) == EVALUATIONS // BATCH
    # The time that a generation took is another each time: these are the same generations.
    assert after[: len(before)] == before
    assert spent(store.run_folder(CELL)) == EVALUATIONS


@pytest.mark.slow
def test_the_figures_are_those_of_the_run(killed):
    store, *_ = killed
    figures = store.load([CELL])[CELL]
    summary = RunFolder(store.run_folder(CELL)).summary()
    archive = RunFolder(store.run_folder(CELL)).archive()

    assert figures.evaluations == EVALUATIONS
    assert figures.batch_size == BATCH
    assert not figures.inferred
    assert figures.valid == summary["valid"]
    assert figures.valid + figures.rejected + figures.discarded == EVALUATIONS
    assert figures.archive_size == len(archive.fields["expert"])
    assert figures.elites.both + figures.elites.expert_only == figures.success_archive_size
    assert figures.success_archive_size == int(archive.fields["expert"].sum())
    assert figures.curve.evaluations[-1] == EVALUATIONS
    assert figures.curve.success_archive_size[-1] == figures.success_archive_size
    assert figures.curve.outcomes[-1] == figures.outcomes
    assert figures.seconds == summary["seconds"]
    assert "CPUs" in figures.machine
    assert figures.commit == describe_commit()
    assert figures.capacity == sum(np.prod(grid["dims"]) for grid in summary["grids"])
    assert (figures.switches, figures.functionals) == ((), "")


def test_a_run_of_another_cell_is_refused(finished):
    with pytest.raises(CellError, match=r"Expected the run of the cell faucet\.ga\.seed-6"):
        read_run(
            finished, cell=Cell.of("faucet", "ga", 6), steering="direct", machine="", commit=""
        )


def test_a_finished_run_whose_figures_were_not_kept_is_not_run_again(finished, tmp_path):
    store = CellStore(tmp_path, EVALUATIONS, BATCH)
    store.prepare()
    shutil.copytree(finished, store.run_folder(CELL))

    outcome = Campaign(store, command=fail_if_called, jobs=1).run(
        [CELL], on_work=ignore, on_cell=ignore
    )

    assert outcome.failed == {}
    assert CELL in store.load([CELL])


def test_a_run_of_another_scale_does_not_go_on(finished, tmp_path):
    store = CellStore(tmp_path, 2 * EVALUATIONS, BATCH)
    store.prepare()
    shutil.copytree(finished, store.run_folder(CELL))
    (store.run_folder(CELL) / "summary.json").unlink()

    outcome = Campaign(store, command=fail_if_called, jobs=1).run(
        [CELL], on_work=ignore, on_cell=ignore
    )

    assert "Expected a run of 192 evaluations, 8 a generation" in outcome.failed[CELL]
    assert "but it has 96 and 8; give each scale a folder of its own" in outcome.failed[CELL]


def fail_if_called(_cell, _folder):
    raise AssertionError("this run is finished, or of another scale")


COPY = "import shutil, sys; shutil.copytree(sys.argv[1], sys.argv[2], dirs_exist_ok=True)"


@pytest.fixture
def stand_in(finished, tmp_path):
    """Return a command that makes the run folder of each seed but 3 by copying, at once."""

    def command(cell, folder):
        if cell.seed == 3:
            words = "print('a note'); import sys; sys.exit('lqd: Expected luck, but got none.')"
            return [sys.executable, "-S", "-c", words]
        made = tmp_path / f"made-{cell.name}"
        shutil.copytree(finished, made)
        for name in ("config.json", "summary.json"):
            data = json.loads((made / name).read_text())
            changes = {"seed": cell.seed, "sample": cell.sample}
            (made / name).write_text(json.dumps(data | changes))
        return [sys.executable, "-S", "-c", COPY, str(made), str(folder)]

    return command


def cells(*seeds):
    return [Cell.of("faucet", "handcrafted", seed) for seed in seeds]


def test_a_cell_that_fails_does_not_keep_the_others_from_being_run(stand_in, tmp_path):
    store = CellStore(tmp_path / "out", EVALUATIONS, BATCH)
    seen = []

    outcome = Campaign(store, command=stand_in, jobs=2).run(
        cells(1, 2, 3, 4, 5), on_work=ignore, on_cell=seen.append
    )

    assert sorted(figures.seed for figures in seen) == [1, 2, 4, 5]
    assert outcome.failed == {cells(3)[0]: "exit status 1: lqd: Expected luck, but got none."}
    assert list(store.load(cells(1, 2, 3, 4, 5))) == cells(1, 2, 4, 5)


def test_a_cell_that_was_killed_from_outside_says_so(tmp_path):
    store = CellStore(tmp_path / "out", EVALUATIONS, BATCH)
    words = "print('12 of 96', flush=True); import os, signal; os.kill(os.getpid(), signal.SIGKILL)"

    outcome = Campaign(store, command=lambda *_: [sys.executable, "-S", "-c", words], jobs=1).run(
        [CELL], on_work=ignore, on_cell=ignore
    )

    assert outcome.failed == {CELL: "ended from outside (Killed), after it had printed: 12 of 96"}


def test_all_commits_that_a_cell_was_run_at_are_kept(stand_in, finished, tmp_path, monkeypatch):
    store = CellStore(tmp_path / "out", EVALUATIONS, BATCH)
    store.prepare()
    one, other = cells(1, 2)
    shutil.copytree(finished, store.run_folder(one))
    (store.run_folder(one) / "summary.json").unlink()
    store.note_commit(one, "earlier")
    # Its run was deleted, to be run again.
    store.note_commit(other, "deleted")
    commits = iter(["begun", "ended", "same", "same"])
    monkeypatch.setattr(campaign, "describe_commit", lambda: next(commits))

    for cell in (one, other):
        Campaign(store, command=stand_in, jobs=1).run([cell], on_work=ignore, on_cell=ignore)

    found = store.load([one, other])
    assert found[one].commit == "earlier, begun, ended"
    assert found[other].commit == "same"


def test_a_cell_that_another_process_runs_is_left_to_it(stand_in, tmp_path):
    store = CellStore(tmp_path / "out", EVALUATIONS, BATCH)
    store.prepare()

    with store.claim(cells(1)[0]):
        outcome = Campaign(store, command=stand_in, jobs=2).run(
            cells(1, 2), on_work=ignore, on_cell=ignore
        )

    assert outcome.elsewhere == cells(1)
    assert list(store.load(cells(1, 2))) == cells(2)


def test_a_new_cell_and_one_that_goes_on_have_their_commands(tmp_path):
    command = run_command(evaluations=20_480, batch_size=512)
    cell = Cell.of("push", "ga", 8)

    begin = [str(part) for part in command(cell, tmp_path / "new")][1:]
    go_on = [str(part) for part in command(cell, tmp_path)][1:]

    head = ["-m", "lqd_search", "run", "--threads", "1"]
    assert begin[:5] == go_on[:5] == head
    assert " ".join(begin[5:]) == (
        f"LQD/Push-v0 --method ga --out {tmp_path / 'new'} --seed 8 --sample 3 "
        "--evaluations 20480 --batch-size 512"
    )
    assert go_on[5:] == ["--resume", str(tmp_path)]


def test_progress_says_how_many_are_finished_and_how_much_is_left(make_figures):
    text = io.StringIO()
    progress = CampaignProgress(
        finished=3, total=8, evaluations=320, begun=40, console=Console(file=text, width=160)
    )

    with progress:
        progress.show_work(80)
        progress.show_cell(make_figures(Cell.of("faucet", "ours", 1)))

    shown = text.getvalue()
    assert "faucet.ours.seed-1.sample-1: 6 successes, 5 cells, 1,800 s; 4/8 cells, " in shown
    assert shown.splitlines()[-1].startswith("4/8 cells")
    assert " 50% " in shown
    assert progress.finished == 4
