"""`python -m benchmarks.tables` and `python -m benchmarks.tables.ablations`."""

import click
import pytest
from click.testing import CliRunner

from benchmarks.tables import __main__ as tables
from benchmarks.tables import ablations, command, report
from benchmarks.tables.ablation_study import ABLATIONS
from benchmarks.tables.campaign import Outcome
from benchmarks.tables.cell import Cell
from benchmarks.tables.cell_store import CellStore
from benchmarks.tables.study import TABLES, StudyError


@pytest.fixture
def keep(tmp_path, make_figures):
    """Return a way to keep made-up cells of the smoke scale."""
    store = CellStore(tmp_path / "out", 320, 8)
    store.prepare()

    def keep_cells(cells, **changes):
        for cell in cells:
            store.keep(make_figures(cell, **changes))
        return str(store.out)

    return keep_cells


@pytest.fixture(autouse=True)
def no_pictures(monkeypatch):
    """Draw nothing: that takes seconds, and the tests of the report see to it."""
    monkeypatch.setattr(report, "figure_files", lambda name, _figure: {f"{name}.png": b""})


class NoCampaign:
    """In the place of one that would run cells."""

    asked: list
    outcome = Outcome()

    def __init__(self, *_, **__):
        pass

    def run(self, cells, *, on_work, on_cell):
        NoCampaign.asked = list(cells)
        on_work(0)
        assert callable(on_cell)
        return self.outcome


@pytest.fixture
def no_campaign(monkeypatch):
    monkeypatch.setattr(command, "Campaign", NoCampaign)
    return NoCampaign


def invoke(main, *arguments):
    return CliRunner().invoke(main, [str(a) for a in arguments], catch_exceptions=False)


def test_a_report_needs_only_the_finished_cells(keep, no_campaign):
    no_campaign.asked = []
    out = keep(TABLES["smoke"].cells[:7])

    result = invoke(tables.main, "--scale", "smoke", "--out", out, "--report")

    assert result.exit_code == 0
    assert result.output == f"{out}/tables.md\n{out}/tables.csv\n"
    assert no_campaign.asked == []


def test_what_is_finished_is_not_run_again(keep, no_campaign):
    cells = TABLES["smoke"].cells
    out = keep(cells[:7])

    result = invoke(tables.main, "--out", out, "--jobs", 1)

    assert result.exit_code == 0
    assert no_campaign.asked == list(cells[7:])


def test_only_some_cells_can_be_asked_for(keep, no_campaign):
    out = keep([Cell.of("push", "ga", 0)])

    invoke(tables.main, "--out", out, "--methods", "ga, ours", "--tasks", "push", "--seeds", "0-0")

    assert no_campaign.asked == [Cell.of("push", "ours", 0)]


def test_who_stops_it_is_told_how_to_go_on(keep, monkeypatch):
    class Interrupted(NoCampaign):
        def run(self, *_, **__):
            raise KeyboardInterrupt

    monkeypatch.setattr(command, "Campaign", Interrupted)
    monkeypatch.setattr("sys.argv", ["tables", "--scale", "smoke", "--out", "a folder"])
    out = keep(TABLES["smoke"].cells[:7])

    result = invoke(tables.main, "--scale", "smoke", "--out", out)

    assert result.exit_code == 130
    assert result.output.splitlines()[-1] == (
        "stopped; 7 of 24 cells are finished, and those under way go on where they were: go on "
        "with `python -m benchmarks.tables --scale smoke --out 'a folder'`"
    )


def test_a_cell_without_a_result_is_named_and_the_tables_are_written(keep, monkeypatch):
    cell = Cell.of("push", "ga", 0)

    class Failing(NoCampaign):
        outcome = Outcome(failed={cell: "exit status 2: lqd: why"}, elsewhere=[])

    monkeypatch.setattr(command, "Campaign", Failing)
    out = keep([])

    result = invoke(tables.main, "--out", out)

    assert result.exit_code == 1
    assert "push.ga.seed-0.sample-0 has no result: exit status 2: lqd: why\n" in result.output
    assert result.output.endswith("tables.csv\n")


def test_a_cell_that_is_run_elsewhere_is_named_and_has_no_result_yet(keep, monkeypatch):
    class Busy(NoCampaign):
        outcome = Outcome(failed={}, elsewhere=[Cell.of("push", "ga", 0)])

    monkeypatch.setattr(command, "Campaign", Busy)

    result = invoke(tables.main, "--out", keep([]))

    assert result.exit_code == 1
    assert "note: another process is running push.ga.seed-0.sample-0" in result.output


def test_a_seed_that_is_not_declared_is_refused(keep):
    with pytest.raises(StudyError, match="Expected some of 0, which are declared"):
        invoke(tables.main, "--out", keep([]), "--seeds", "0-3")


@pytest.mark.parametrize("text", ["one", "4-0", "0-", "-1", "0-1-2", "1,,2", ""])
def test_what_is_no_seed_is_refused(text):
    result = invoke(tables.main, "--seeds", text)

    assert result.exit_code == 2
    assert f"expected seeds such as 0,3 or 0-4, but got {text!r}" in result.output


@pytest.mark.parametrize(("text", "seeds"), [("3", [3]), ("0-2,7", [0, 1, 2, 7]), ("4, 5", [4, 5])])
def test_seeds_are_numbers_and_ranges(text, seeds):
    context, parameter = click.Context(tables.main), tables.main.params[0]

    assert command.seeds(context, parameter, text) == seeds


def test_the_ablations_report_variants_comparisons_and_variances(keep, tmp_path):
    cells = ABLATIONS["smoke"].cells
    out = keep(cells)
    for i, cell in enumerate(c for c in cells if c.method == "ours"):
        keep([cell], success_archive_size=10 + i * i)

    result = invoke(ablations.main, "--out", out, "--report")

    assert result.exit_code == 0
    text = (tmp_path / "out" / "tables.md").read_text()
    assert text.startswith("# Ablations of `ours`, scale `smoke`\n")
    assert "| one_grid | the first h with the first g, 1 grid |" in text
    assert "## Drawer: the final archive" in text
    assert "| faucet | success archive size | ours : first_fitness |" in text
    assert (
        "| drawer | ground-truth cells | 4 | 5.0 ± 0.0 | nothing varies | nothing varies |" in text
    )
    assert "| faucet | success archive size | 4 | " in text


def test_an_incomplete_crossing_has_no_shares(keep, tmp_path):
    out = keep([Cell("faucet", "ours", 0, 0)])

    invoke(ablations.main, "--out", out, "--report")

    text = (tmp_path / "out" / "tables.md").read_text()
    assert "| faucet | success archive size | 1 of 4 | - | - | - |" in text


def test_cells_of_ours_are_taken_from_the_tables(keep, tmp_path, make_figures, no_campaign):
    there = keep([Cell.of("faucet", "ours", 0), Cell.of("push", "ours", 0)])

    result = invoke(ablations.main, "--out", tmp_path / "new", "--tables", there)

    assert result.exit_code == 0
    assert f"1 cells taken from {there}\n" in result.output
    assert Cell.of("faucet", "ours", 0) not in no_campaign.asked
    assert len(no_campaign.asked) == len(ABLATIONS["smoke"].cells) - 1
    kept = CellStore(tmp_path / "new", 320, 8).load([Cell.of("faucet", "ours", 0)])
    assert kept == {Cell.of("faucet", "ours", 0): make_figures(Cell.of("faucet", "ours", 0))}
