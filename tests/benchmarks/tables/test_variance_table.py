"""The table of the model's variance and the search's, of made-up cells."""

import pytest

from benchmarks.tables.ablation_study import ABLATIONS, CROSSINGS
from benchmarks.tables.results import Results
from benchmarks.tables.variance_table import variance_table


@pytest.fixture
def row(make_figures):
    def row(size_of, *, leave_out=0):
        cells = CROSSINGS["small"].cells("drawer")[leave_out:]
        figures = {c: make_figures(c, success_archive_size=size_of(c)) for c in cells}
        text = variance_table(Results(ABLATIONS["small"], figures))
        found = (line for line in text.splitlines() if line.startswith("| drawer | success"))
        return next(found).strip("| ").split(" | ")[2:]

    return row


def test_what_only_recordings_make_differ_is_the_models(row):
    assert row(lambda cell: 100 * cell.sample) == [
        *("15", "200.0 ± 146.4", "100% [100%, 100%]", "0% [0%, 0%]", "0% [0%, 0%]"),
        "0% [0%, 0%]",
    ]


def test_what_only_seeds_make_differ_is_the_searchs(row):
    assert row(lambda cell: 100 * cell.seed)[2:] == [
        *("0% [0%, 0%]", "100% [100%, 100%]", "100% [100%, 100%]", "0% [0%, 0%]"),
    ]


def test_without_variance_there_are_no_shares(row):
    assert row(lambda _: 85) == ["15", "85.0 ± 0.0", *["nothing varies"] * 4]


def test_it_waits_for_all_pairs(row):
    assert row(lambda cell: cell.seed, leave_out=2) == ["13 of 15", *["-"] * 5]
