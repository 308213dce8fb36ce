"""Registering tasks as Gymnasium environments."""

import gymnasium as gym

from lqd_envs.env import MAX_EPISODE_STEPS
from lqd_envs.tasks.registry import add_task
from lqd_envs.tasks.task import Task


def register_task(task: Task) -> None:
    """Make a task known by its id, to `lqd_envs` and to Gymnasium.

    After it, `lqd_envs.rollout(task.id, ...)`, `gymnasium.make(task.id)` and
    `gymnasium.make_vec(task.id)` work. Registering the same task again does nothing.

    Args:
        task: The task; its id has the form `Namespace/Name-v0`.

    Raises:
        DuplicateTaskError: Another task has this id.
    """
    add_task(task)
    if task.id not in gym.registry:
        gym.register(
            id=task.id,
            entry_point="lqd_envs.env:ManipulationEnv",
            vector_entry_point="lqd_envs.vector_env:ManipulationVectorEnv",
            kwargs={"task": task.id},
            max_episode_steps=MAX_EPISODE_STEPS,
        )
