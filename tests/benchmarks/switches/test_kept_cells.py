"""Runs with switches on disk, and the command's own answers."""

import json
from dataclasses import asdict

import pytest

from benchmarks.switches.__main__ import main
from benchmarks.switches.kept_cells import SwitchesError, load
from benchmarks.tables.command import call


@pytest.fixture
def out(tmp_path, make_cell):
    (tmp_path / "faucet.ours.100.json").write_text(json.dumps(asdict(make_cell(commit="abc"))))
    return tmp_path


def test_what_is_kept_is_there_again(out, make_cell):
    assert load(out, evaluations=20_480, batch_size=512) == [make_cell(commit="abc")]


def test_a_run_may_be_older_than_its_commit(out, make_cell):
    figures = asdict(make_cell())
    del figures["commit"]
    (out / "faucet.ours.100.json").write_text(json.dumps(figures))
    assert load(out, evaluations=20_480, batch_size=512) == [make_cell()]


@pytest.mark.parametrize(("evaluations", "batch_size"), [(5_120, 512), (20_480, 256)])
def test_runs_of_another_budget_are_refused(out, evaluations, batch_size):
    message = (
        rf"Expected runs of {evaluations} .* but that of ours on faucet has 20480 and 512; give"
    )
    with pytest.raises(SwitchesError, match=message):
        load(out, evaluations=evaluations, batch_size=batch_size)


@pytest.mark.parametrize("text", ["{", "[]", '{"task": 3}', "null"])
def test_a_damaged_run_is_named(out, text):
    (out / "faucet.ours.100.json").write_text(text)
    with pytest.raises(SwitchesError, match=r"figures of a run in \S+faucet\.ours\.100\.json, but"):
        load(out, evaluations=20_480, batch_size=512)


@pytest.fixture
def switches(monkeypatch, capsys):
    """Call the command; return its status, and what it printed."""

    def switches(*arguments):
        monkeypatch.setattr("sys.argv", ["switches", *map(str, arguments)])
        with pytest.raises(SystemExit) as ended:
            call(main)
        return ended.value.code, *capsys.readouterr()

    return switches


def test_an_unknown_switch_is_one_sentence(out, switches):
    status, printed, error = switches("--out", out, "--combined", "line+typo")
    assert (status, printed) == (2, "")
    assert error == (
        "switches: Expected switches among line, random, credit, screen, contact, evolution, "
        "many_cells, joined by +, but got 'typo'.\n"
    )


def test_a_table_without_runs_is_empty(out, switches):
    status, printed, _ = switches("--out", out, "--table")
    assert status == 0
    assert len(printed.splitlines()) == 2
