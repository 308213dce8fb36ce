"""Random motions of a task, as many as are asked for."""

from collections.abc import Iterator

import numpy as np

from lqd_envs import SolutionSpace, Task, Trajectories, rollout

_BATCH = 4_000


def random_trajectories(
    task: Task, *, most: int, rng: np.random.Generator
) -> Iterator[Trajectories]:
    """Simulate uniform random solutions, a batch whenever the next one is asked for.

    Args:
        task: The task.
        most: Solutions in all batches together.
        rng: Draws the solutions.

    Yields:
        The trajectories of a batch, in the order of its solutions.
    """
    for start in range(0, most, _BATCH):
        yield rollout(task, SolutionSpace().sample(min(_BATCH, most - start), rng=rng))
