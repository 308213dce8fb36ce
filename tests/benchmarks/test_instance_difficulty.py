"""How hard instances are for random successes."""

import numpy as np
import pytest

from benchmarks.instance_difficulty import random_successes, shares_solved
from lqd_envs import get_task, rollout
from lqd_envs.instances import generate_instances

TASK = get_task("LQD/Push-v0")


@pytest.fixture(scope="module")
def successes():
    return random_successes(TASK, count=3, most=1_000, seed=0)


def test_random_successes_are_the_first_ones_and_succeed(successes):
    few = random_successes(TASK, count=1, most=1_000, seed=0)

    assert len(successes) == 3
    assert np.array_equal(few, successes[:1])
    assert rollout(TASK, successes).success().all()


def test_nothing_is_drawn_beyond_the_most():
    assert random_successes(TASK, count=2, most=8, seed=0).shape == (0, 9)


def test_shares_are_those_of_the_motions_that_solve(successes):
    motions = rollout(TASK, successes)
    instances = generate_instances(TASK, "approach", count=3, seed=0)

    shares = shares_solved(TASK, successes, instances)

    assert shares.tolist() == [instance.solved_by(motions).mean() for instance in instances]
