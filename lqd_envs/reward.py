"""The rewards of the environments."""

from collections.abc import Callable
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from lqd_envs.errors import LQDError
from lqd_envs.perception import Columns
from lqd_envs.tasks.task import Task

Reward = Callable[[Task, Columns], NDArray[np.float64]]
"""A task and (N, T, ...) columns to (N,) rewards of the last moment, given the first."""

_SHAPED_SHARE = 0.5


def sparse_reward(task: Task, columns: Columns) -> NDArray[np.float64]:
    """Return 1 at success and 0 otherwise, (N,) float64."""
    return task.success(columns).astype(np.float64)


def dense_reward(task: Task, columns: Columns) -> NDArray[np.float64]:
    """Return 1 at success and otherwise half the task's nearness, (N,) float64 in [0, 1]."""
    return np.where(task.success(columns), 1.0, _SHAPED_SHARE * task.nearness(columns))


REWARDS = MappingProxyType({"sparse": sparse_reward, "dense": dense_reward})
"""The rewards by name."""


def get_reward(name: str) -> Reward:
    """Return the reward of a name.

    Raises:
        LQDError: There is none of that name; the message names those there are.
    """
    if not isinstance(name, str) or name not in REWARDS:
        raise LQDError(f"expected a reward of {', '.join(REWARDS)}, got {name!r}")
    return REWARDS[name]
