"""Real motions of every task."""

from functools import cache

import numpy as np
import pytest

from lqd_envs import SolutionSpace, rollout

# Turns the hot tap by 1.57 rad.
TURNING = (0.07, 0.68, -0.05, 0.47, -0.83, 2.41, -0.47, -0.51, 0.06)


@pytest.fixture(scope="session")
def solutions():
    """(80, 9): one that turns on the hot water, and random ones, of which many cannot start."""
    random = SolutionSpace().sample(79, rng=np.random.default_rng(0))
    return np.concatenate([[TURNING], random])


@pytest.fixture(scope="session")
def motions_of(solutions):
    """A function that gives these solutions' motions in any task, simulated once."""
    return cache(lambda task_id: rollout(task_id, solutions))


@pytest.fixture(scope="session")
def faucet_motions(motions_of):
    """Their motions at the faucet."""
    return motions_of("LQD/Faucet-v0")
