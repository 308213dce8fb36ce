"""Motions of a task that show what can happen in it, for trying functions on."""

import json
from importlib import resources

import numpy as np
from numpy.typing import NDArray

from lqd_envs.solution_space import SolutionSpace
from lqd_envs.tasks.registry import PAPER_TASKS
from lqd_envs.tasks.task import Task

_SEED = 0
_RANDOM = 64


def example_solutions(task: Task) -> NDArray[np.float64]:
    """Return solutions whose motions show what can happen in a task.

    First 64 random ones, the same for every task. For the tasks of the paper there follow 24 that
    were chosen from 8,192 random ones: the 16 valid ones that moved the object or a joint of it
    farthest, and the first 8 others that touched it (`benchmarks/example_motions.py`). What the
    expert says of them played no part.

    Args:
        task: The task.

    Returns:
        (n, 9) feasible solutions, of which not all need be valid.
    """
    drawn = SolutionSpace().sample(_RANDOM, rng=np.random.default_rng(_SEED))
    if task not in PAPER_TASKS:
        return drawn
    file = resources.files("lqd_envs").joinpath("tasks", "examples", f"{task.name}.json")
    return np.concatenate([drawn, np.array(json.loads(file.read_text("utf-8")))])
