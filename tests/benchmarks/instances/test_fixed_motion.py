"""One fixed motion for all instances."""

import numpy as np
import pytest

from benchmarks.instances.fixed_motion import CHOICES, solved_by_one, solves_of
from benchmarks.instances.looked_at import LookedAt

# In which of five instances each of four motions solves.
SOLVES = np.array(
    [
        [0, 1, 0, 0],
        [0, 1, 0, 1],
        [0, 0, 0, 1],
        [0, 0, 1, 0],
        [0, 0, 1, 0],
    ],
    dtype=bool,
)


def looked_at(solves, *, rows=None, evaluation=None):
    """Return what was looked at of an archive of as many motions, instance by instance."""
    n = solves.shape[1]
    chosen = [np.arange(n)] * len(solves) if rows is None else [np.array(r, int) for r in rows]
    numbers = np.arange(n) if evaluation is None else np.array(evaluation)
    pairs = zip(chosen, solves, strict=True)
    return [LookedAt.of(which, solved, evaluation=numbers) for which, solved in pairs]


def test_in_hindsight_it_is_the_one_that_solves_the_most_and_was_evaluated_first():
    found = solved_by_one(looked_at(SOLVES), "hindsight")

    # The motions 1, 2 and 3 solve two instances each.
    assert found.tolist() == [True, True, False, False, False]


def test_the_order_is_that_of_evaluation_and_not_of_the_archive():
    found = solved_by_one(looked_at(SOLVES, evaluation=[0, 9, 2, 4]), "hindsight")

    assert found.tolist() == [False, False, False, True, True]


def test_left_out_it_is_chosen_by_the_other_instances():
    found = solved_by_one(looked_at(SOLVES), "leave-one-out")

    # Without the first or the second instance it is motion 2, which solves neither; without one of
    # the last three it is motion 1, which solves none of them.
    assert found.tolist() == [False, False, False, False, False]


def test_left_out_one_that_solves_most_is_chosen_every_time():
    solves = np.array([[1, 0, 0], [1, 1, 0], [1, 0, 1], [0, 1, 0]], dtype=bool)

    found = solved_by_one(looked_at(solves), "leave-one-out")

    # Motion 0 solves the most of the others, or as many as motion 1, each time.
    assert found.tolist() == [True, True, True, False]


def test_only_what_was_looked_at_everywhere_can_be_chosen():
    solves = np.array([[1, 1, 0], [1, 0, 1], [1, 0, 0]], dtype=bool)
    row = looked_at(solves, rows=[[0, 1, 2], [1, 2], [0, 1, 2]])

    assert solves_of(row).tolist() == [[True, False], [False, True], [False, False]]
    assert solved_by_one(row, "hindsight").tolist() == [True, False, False]


@pytest.mark.parametrize("choice", CHOICES)
def test_where_nothing_was_looked_at_everywhere_nothing_solves(choice):
    row = looked_at(np.ones((2, 2), bool), rows=[[0], [1]])

    assert solved_by_one(row, choice).tolist() == [False, False]
    assert solved_by_one(looked_at(np.ones((2, 0), bool)), choice).tolist() == [False, False]


def test_no_fixed_motion_is_above_the_one_in_hindsight():
    rng = np.random.default_rng(0)
    for _ in range(50):
        solves = rng.random((6, 9)) < 0.3
        hindsight, others = (solved_by_one(looked_at(solves), choice) for choice in CHOICES)

        assert hindsight.sum() == solves.sum(axis=0).max()
        assert others.sum() <= hindsight.sum()
        assert hindsight.sum() <= solves.any(axis=1).sum()
