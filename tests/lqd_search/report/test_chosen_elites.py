import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lqd_envs import GroundTruth
from lqd_search.report.chosen_elites import choose_elites
from lqd_search.runs.stored_archive import StoredArchive


def line_of(cells):
    return GroundTruth(lambda _: np.zeros((0, 1)), ("place (m)",), (cells,), ((0.0, float(cells)),))


def archive_of(places, objective, *, expert=None, success=None):
    n = len(places)
    everywhere = np.ones(n, dtype=bool)
    fields = {
        "solution": np.zeros((n, 9)),
        "objective": np.asarray(objective, dtype=np.float64),
        "success": everywhere if success is None else np.asarray(success),
        "expert": everywhere if expert is None else np.asarray(expert),
        "ground_truth": np.asarray(places, dtype=np.float64).reshape(n, 1),
        "evaluation": np.arange(n),
        "digest": np.zeros(n, dtype=np.uint64),
    }
    return StoredArchive(fields, {})


def chosen(archive, n, *, cells=10):
    return choose_elites(archive, ground_truth=line_of(cells), n=n).tolist()


def test_the_first_is_the_fittest_and_the_next_are_the_farthest():
    archive = archive_of([0.5, 3.5, 4.5, 9.5], [0.1, 0.9, 0.2, 0.3])

    assert chosen(archive, 3) == [1, 3, 0]


def test_of_a_cell_the_fittest_is_taken_and_of_equal_ones_the_earlier():
    archive = archive_of([2.1, 2.5, 2.9, 7.5], [0.1, 0.5, 0.5, 0.5])

    assert chosen(archive, 9) == [1, 3]


def test_a_success_without_a_fitness_comes_last():
    archive = archive_of([2.1, 2.5, 7.5], [np.nan, -5.0, np.nan])

    assert chosen(archive, 9) == [1, 2]


def test_what_the_expert_approves_goes_before_what_the_inferred_condition_does():
    places, objective, none = [1.5, 5.5], [0.0, 1.0], [False, False]

    assert chosen(archive_of(places, objective, expert=[True, False]), 9) == [0]
    assert chosen(archive_of(places, objective, expert=none, success=[True, False]), 9) == [0]
    assert chosen(archive_of(places, objective, expert=none, success=none), 9) == []


def test_what_is_outside_the_grid_is_left_out():
    assert chosen(archive_of([-1.0, np.nan, 3.0], [3.0, 2.0, 1.0]), 9) == [2]


@pytest.mark.parametrize("n", [0, 1])
def test_no_more_are_chosen_than_asked_for(n):
    assert len(chosen(archive_of([1.5, 5.5], [0.0, 1.0]), n)) == n


@given(st.lists(st.tuples(st.floats(0, 10), st.floats(-1, 1)), max_size=30), st.integers(0, 12))
def test_no_cell_is_chosen_twice(motions, n):
    archive = archive_of([place for place, _ in motions], [worth for _, worth in motions])
    cells = np.minimum(archive.fields["ground_truth"][:, 0].astype(int), 9)

    rows = chosen(archive, n)

    assert len(rows) == min(n, len(np.unique(cells)))
    assert len(np.unique(cells[rows])) == len(rows)
