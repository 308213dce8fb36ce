"""Registering every task with Gymnasium."""

import gymnasium as gym

from lqd_envs.env import MAX_EPISODE_STEPS
from lqd_envs.tasks.registry import TASKS


def register_envs() -> None:
    """Register every task under its id; ids that are registered already are left alone."""
    for task_id in TASKS:
        if task_id not in gym.registry:
            gym.register(
                id=task_id,
                entry_point="lqd_envs.env:ManipulationEnv",
                kwargs={"task": task_id},
                max_episode_steps=MAX_EPISODE_STEPS,
            )
