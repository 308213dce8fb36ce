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


def test_of_two_instances_each_chooses_for_the_other():
    # By the first instance it is motion 1, by the second one motion 0, the first that solves it.
    solves = np.array([[0, 1, 1], [1, 1, 0]], dtype=bool)

    assert solved_by_one(looked_at(solves), "other half").tolist() == [0.0, 1.0]


def test_one_that_solves_the_most_of_any_half_is_chosen_every_time():
    solves = np.zeros((6, 4), dtype=bool)
    solves[:, 2] = True
    solves[0, 2], solves[[1, 2], 3] = False, True

    assert solved_by_one(looked_at(solves), "other half").tolist() == [0.0, 1.0, 1.0, 1.0, 1.0, 1.0]


def test_each_half_chooses_as_often_as_all_halves_would():
    # Each of four motions solves one of four instances: whatever two choose, the first motion of
    # the two or one that solves neither of the others, it fails in the other half.
    assert solved_by_one(looked_at(np.eye(4, dtype=bool)), "other half").tolist() == [0.0] * 4
    # Two motions for two instances each: by a half with both of a pair the other pair is lost, by
    # any other half the first motion is chosen.
    solves = np.array([[1, 0], [1, 0], [0, 1], [0, 1]], dtype=bool)

    found = solved_by_one(looked_at(solves), "other half")

    # Of the three ways to halve them one keeps the pairs together.
    assert found[:2] == pytest.approx([2 / 3] * 2, abs=0.1)
    assert found[2:].tolist() == [0.0, 0.0]


def test_the_choice_does_not_turn_against_the_instance_that_it_is_judged_by():
    # Of many motions each solves a random half of the instances: so does the one that is chosen.
    rng = np.random.default_rng(0)
    worth = [
        solved_by_one(looked_at(rng.random((20, 200)) < 0.5), "other half").mean()
        for _ in range(40)
    ]

    assert np.mean(worth) == pytest.approx(0.5, abs=0.03)
    # Chosen by all the others but the one, it would be 0 or 1 together for nearly all of them.
    assert np.std(worth) < 0.1


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
        hindsight, halves = (solved_by_one(looked_at(solves), choice) for choice in CHOICES)

        assert hindsight.sum() == solves.sum(axis=0).max()
        assert halves.sum() <= hindsight.sum()
        assert hindsight.sum() <= solves.any(axis=1).sum()
