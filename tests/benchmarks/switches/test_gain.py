"""The rule by which a switch pays."""

import pytest

from benchmarks.switches.gain import TASKS, TUNING_SEEDS, gains, given_up, table
from benchmarks.tables.study import TABLES


@pytest.fixture
def runs(make_cell):
    """Return the runs of `ours` and of a switch that multiplies sizes and cells, seed by seed."""

    def make(task, name, sizes, cells):
        return [
            cell
            for seed, size, filled in zip(TUNING_SEEDS, sizes, cells, strict=True)
            for cell in (
                make_cell(task, seed=seed),
                make_cell(
                    task,
                    name,
                    seed,
                    success_archive_size=round(100 * size) - 1,
                    ground_truth_cells=round(100 * filled) - 1,
                ),
            )
        ]

    return make


@pytest.mark.parametrize(
    ("sizes", "cells", "pays"),
    [
        ([1.05] * 5, [0.95] * 5, True),
        ([0.95] * 5, [1.05] * 5, True),
        ([1.04] * 5, [1.04] * 5, False),
        ([1.77] * 5, [0.94] * 5, False),
        # The median counts, not the mean.
        ([1.04, 1.04, 1.04, 9.0, 9.0], [1.0] * 5, False),
        ([1.05, 1.05, 1.05, 0.1, 0.1], [1.0] * 5, True),
    ],
)
def test_it_pays_where_one_gains_and_the_other_does_not_lose(runs, sizes, cells, pays):
    (gain,) = gains(runs("push", "line", sizes, cells))

    assert gain.size == pytest.approx(sizes)
    assert gain.cells == pytest.approx(cells)
    assert gain.pays == pays
    assert gain.verdict == ("yes" if pays else "no")


def test_a_switch_is_compared_when_all_its_seeds_are_there(runs):
    cells = runs("push", "line", [2.0] * 5, [2.0] * 5)
    assert gains(cells[:-1]) == []
    assert len(gains(cells)) == 1


def test_a_switch_that_failed_on_two_tasks_is_given_up(runs):
    cells = runs("push", "line", [1.0] * 5, [0.99] * 5)
    assert not given_up("line", cells)
    cells += runs("grasp", "line", [1.0] * 5, [0.99] * 5)
    assert given_up("line", cells)
    assert not given_up("screen", cells)


def test_a_switch_that_had_nothing_to_do_did_not_pay(runs):
    cells = runs("push", "many_cells", [1.0] * 5, [0.99] * 5)
    cells += runs("grasp", "many_cells", [1.0] * 5, [1.0] * 5)

    assert [gain.verdict for gain in gains(cells)] == ["no effect", "no"]
    assert given_up("many_cells", cells)


def test_the_table_has_medians_and_quartiles(runs):
    cells = runs("push", "line", [1.0, 1.1, 1.2, 1.3, 1.4], [1.0] * 5)
    assert table(cells).splitlines()[2:] == [
        "| line | push | 1.20 [1.10, 1.30] | 1.00 [1.00, 1.00] | yes |"
    ]


def test_no_benchmark_uses_the_seeds():
    used = {cell.seed for study in TABLES.values() for cell in study.cells}
    assert used.isdisjoint(TUNING_SEEDS)
    assert set(TASKS) == {cell.task for cell in TABLES["small"].cells}
