"""How hard instances are for random successes."""

import numpy as np

from benchmarks.instance_difficulty import random_successes, shares_solved
from lqd_envs import get_task, rollout
from lqd_envs.instances import generate_instances

TASK = get_task("LQD/Push-v0")


def test_random_successes_are_the_first_ones_and_succeed():
    few = random_successes(TASK, count=2, most=1_000, seed=0)
    more = random_successes(TASK, count=4, most=1_000, seed=0)

    assert len(few) == 2
    assert np.array_equal(more[:2], few)
    assert rollout(TASK, more).success().all()


def test_nothing_is_drawn_beyond_the_most():
    assert random_successes(TASK, count=2, most=8, seed=0).shape == (0, 9)


def test_shares_are_those_of_the_motions_that_solve():
    solutions = random_successes(TASK, count=4, most=1_000, seed=0)
    motions = rollout(TASK, solutions)
    instances = generate_instances(TASK, "approach", count=3, seed=0)

    shares = shares_solved(TASK, solutions, instances)

    assert shares.tolist() == [instance.solved_by(motions).mean() for instance in instances]
