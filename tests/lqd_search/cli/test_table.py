import json

import pytest

from lqd_search.cli.table import print_summary


def printed(summary, capsys, monkeypatch, *, columns=80):
    monkeypatch.setenv("COLUMNS", str(columns))
    print_summary(summary)
    return capsys.readouterr().out


@pytest.fixture
def summary(run):
    return json.loads((run[0] / "summary.json").read_text())


def large(counts):
    return {name: 102_400 if isinstance(n, int) else n for name, n in counts.items()}


def test_large_numbers_fit_into_80_columns(summary, capsys, monkeypatch):
    changes = {
        "evaluations": 102_400,
        "confusion": large(summary["confusion"]),
        "outcomes": large(summary["outcomes"]),
        "grids": [large(grid) for grid in summary["grids"]],
    }

    text = printed(summary | changes, capsys, monkeypatch)

    assert "…" not in text
    assert max(map(len, text.splitlines())) <= 80
    head = next(line for line in text.splitlines() if "precision" in line)
    assert "both inferred only expert only neither precision recall" in " ".join(head.split())


def test_the_distinct_successes_of_the_whole_run_are_there(summary, capsys, monkeypatch):
    outcomes = {
        "both": 30,
        "inferred_only": 5,
        "expert_only": 4,
        "ground_truth_cells": 21,
        "ground_truth_outside": 0,
    }

    lines = printed(summary | {"outcomes": outcomes}, capsys, monkeypatch).splitlines()

    place = next(i for i, line in enumerate(lines) if "distinct successes of the whole" in line)
    assert lines[place].split()[-1] == "34"
    assert lines[place + 1].split() == ["ground-truth", "cells", "21"]
    (row,) = [line.split() for line in lines if "distinct solutions" in line]
    assert row[2:] == ["30", "5", "4", "85.7%", "88.2%"]


def test_without_grids_nothing_is_said_of_them(summary, capsys, monkeypatch):
    changes = {"grids": [], "waiting_descriptors": [], "degenerate_descriptors": ["a.b"]}

    text = printed(summary | changes, capsys, monkeypatch)

    for words in ("Grids", "clipped", "out of range", "coverage", "a.b"):
        assert words not in text


def test_what_waits_for_a_grid_and_what_says_nothing_is_named(summary, capsys, monkeypatch):
    changes = {"grids": [], "waiting_descriptors": ["a.b"], "undefined_descriptors": ["a.b"]}

    text = printed(summary | changes, capsys, monkeypatch)

    assert "Without a grid, since too few motions defined them: a.b." in text
    assert "Defined for no motion of the first batch: a.b." in text


def test_a_grid_of_its_own_is_one_row(summary, capsys, monkeypatch):
    grid = {**summary["grids"][0], "name": "ground_truth", "dims": [100], "filled": 87}

    text = printed(summary | {"grids": [grid]}, capsys, monkeypatch)

    (row,) = [line.split() for line in text.splitlines() if "ground_truth" in line]
    assert row[:3] == ["ground_truth", "100", "87"]


def test_what_the_expert_steers_is_said(summary, capsys, monkeypatch):
    text = printed(summary | {"method": "handcrafted", "llm": "none"}, capsys, monkeypatch)

    assert "Steered by the expert" in text
    assert "recorded sample" not in text


MARKUP = "[red]a[/red] [b.c] [/] [link=x]\\\\"


def test_texts_are_no_markup(summary, capsys, monkeypatch):
    refused = {"kind": f"k{MARKUP}", "functional": f"f{MARKUP}", "reason": MARKUP, "count": 1}
    changes = {
        "task": f"t{MARKUP}",
        "rejected": {f"r{MARKUP}": 1},
        "exploration": {f"e{MARKUP}": 1},
        "chosen_fitness": f"e{MARKUP}",
        "grids": [summary["grids"][0] | {"name": f"h{MARKUP}.g{MARKUP}"}],
        "refused": [refused],
        "waiting_descriptors": [f"w{MARKUP}"],
        "dropped": [f"d{MARKUP}"],
    }

    text = printed(summary | changes, capsys, monkeypatch, columns=300)

    moment, _, quantity = f"h{MARKUP}.g{MARKUP}".partition(".")
    for letter in "tredfkw":
        assert f"{letter}{MARKUP}" in text
    assert f"{MARKUP} (kept)" in text
    assert f" {moment} " in text
    assert f"  {quantity} " in text


def test_solutions_out_of_range_are_summed_over_the_grids(summary, capsys, monkeypatch):
    grids = [summary["grids"][0] | {"clipped": count} for count in (30, 4)]

    lines = printed(summary | {"grids": grids}, capsys, monkeypatch).splitlines()

    (line,) = [line for line in lines if "solutions out of range, over all grids" in line]
    assert line.split()[-1] == "34"
