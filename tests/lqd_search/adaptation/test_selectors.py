"""In which order the motions of an archive are tried."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lqd_envs import SolutionSpace
from lqd_search.adaptation import SELECTORS, ArchiveView
from lqd_search.adaptation.selectors import best_first, farthest_first


def make_view(solution, objective=None, **measures) -> ArchiveView:
    n = len(solution)
    return ArchiveView(
        solution=np.asarray(solution, float),
        objective=np.arange(n, 0, -1.0) if objective is None else np.asarray(objective, float),
        success=np.ones(n, bool),
        digest=np.arange(n, dtype=np.uint64),
        measures={name: np.asarray(column, float) for name, column in measures.items()},
    )


def along_x(*positions):
    """Solutions that differ in x alone."""
    solutions = np.zeros((len(positions), 9))
    solutions[:, 0] = positions
    return solutions


def test_best_first_puts_equal_ones_in_order_and_undefined_ones_last():
    view = make_view(along_x(0, 0, 0, 0, 0), [np.nan, 2.0, 3.0, 2.0, -1.0])

    assert best_first(view, 9).tolist() == [2, 1, 3, 4, 0]
    assert best_first(view, 2).tolist() == [2, 1]


def test_farthest_first_begins_with_the_best_and_goes_where_nothing_is():
    view = make_view(along_x(0.0, 0.1, 0.9, -0.5), [4.0, 3.0, 2.0, 1.0])

    assert farthest_first(view, 4).tolist() == [0, 2, 3, 1]


def test_of_equally_far_ones_the_better_is_taken():
    view = make_view(along_x(0.0, -0.5, 0.5), [5.0, 1.0, 2.0])

    assert farthest_first(view, 2).tolist() == [0, 2]


def test_yaw_goes_the_shorter_way_round():
    solutions = np.zeros((3, 9))
    solutions[:, 5] = (3.1, -3.1, 2.5)

    assert farthest_first(make_view(solutions), 2).tolist() == [0, 2]


def test_measures_count_where_both_have_them():
    # By their solutions the second is farther; by its measure the third is.
    view = make_view(along_x(0.0, 0.5, 0.4), m=[[0.0], [0.0], [1.0]])
    without = make_view(along_x(0.0, 0.5, 0.4), m=[[0.0], [np.nan], [np.nan]])

    assert farthest_first(view, 2).tolist() == [0, 2]
    assert farthest_first(without, 2).tolist() == [0, 1]


def test_the_distance_is_what_it_is_said_to_be():
    # x is 2 wide: mean squares (0.5 / 2)^2 / 9 and (0.6^2 + 0.0) / 2, their mean, against 0.4^2.
    view = make_view(along_x(0.0, 0.5, 0.0), a=[[0.0], [0.6], [0.41]], b=[[0.0], [0.0], [0.43]])
    first = ((0.5 / 2) ** 2 / 9 + 0.6**2 / 2) / 2
    second = (0.41**2 + 0.43**2) / 2 / 2

    assert farthest_first(view, 2).tolist() == [0, 1 if first > second else 2]
    assert first > second


@pytest.mark.parametrize("name", SELECTORS)
@given(n=st.integers(0, 12), count=st.integers(1, 15), seed=st.integers(0, 99))
def test_as_many_distinct_rows_as_asked_for(name, n, count, seed):
    rng = np.random.default_rng(seed)
    # Each twice: motions that are equal are not chosen twice either.
    solutions = np.repeat(SolutionSpace().sample(n, rng=rng), 2, axis=0)
    measures = rng.choice([np.nan, 0.0, 1.0], (2 * n, 2))

    rows = SELECTORS[name].select(make_view(solutions, m=measures), count)

    assert len(rows) == len(set(rows.tolist())) == min(count, 2 * n)
    assert all(0 <= row < 2 * n for row in rows)


@pytest.mark.parametrize("name", SELECTORS)
def test_what_the_expert_says_changes_nothing(name, make_archive, make_grid):
    grids = {"h.g": make_grid([0, 1, 3], [1.0, 4.0, 9.0])}
    plain = make_archive(grids=grids)
    other = make_archive(
        grids=grids, expert=np.zeros(6, bool), ground_truth=np.arange(6.0)[:, None]
    )

    rows, others = (SELECTORS[name].select(ArchiveView.of(a), 6) for a in (plain, other))

    assert rows.tolist() == others.tolist()
