"""Random motions, batch by batch."""

import numpy as np

from benchmarks import random_trajectories as module
from benchmarks.random_trajectories import random_trajectories
from lqd_envs import SolutionSpace, get_task

TASK = get_task("LQD/Push-v0")


def test_batches_follow_one_another_up_to_the_most(monkeypatch):
    monkeypatch.setattr(module, "_BATCH", 4)

    batches = list(random_trajectories(TASK, most=10, rng=np.random.default_rng(3)))

    rng = np.random.default_rng(3)
    expected = [SolutionSpace().sample(n, rng=rng) for n in (4, 4, 2)]
    assert [len(batch) for batch in batches] == [4, 4, 2]
    assert all(np.array_equal(b.solutions, e) for b, e in zip(batches, expected, strict=True))


def test_what_nobody_asks_for_is_not_drawn(monkeypatch):
    monkeypatch.setattr(module, "_BATCH", 4)
    rng = np.random.default_rng(3)

    next(random_trajectories(TASK, most=10**9, rng=rng))

    after = np.random.default_rng(3)
    SolutionSpace().sample(4, rng=after)
    assert rng.random() == after.random()
