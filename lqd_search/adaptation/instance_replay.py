"""Carrying out one solution in an instance, step by step, in the single Gymnasium env."""

from dataclasses import replace

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from lqd_envs import get_task, rollout
from lqd_envs.instances import Instance
from lqd_search.runs.replay import Replay, ReplayError, play


def replay_in(
    instance: Instance, solution: NDArray[np.float64], *, render_mode: str | None = None
) -> Replay:
    """Carry out one solution in the env of an instance.

    Args:
        instance: The instance.
        solution: (9,) the solution.
        render_mode: `"rgb_array"` to collect frames, `"human"` to watch, or None.

    Returns:
        What it showed; `success` says whether the instance was solved: the env's word at the end,
        or False where the motion failed in the batch rollout.

    Raises:
        ReplayError: The solution is rejected before it could be simulated.
        InstanceError: The instance does not fit its task.
        RenderingError: Pictures were asked for and cannot be drawn here.
    """
    batch = rollout(instance.apply(get_task(instance.task)), solution[None])
    if not batch.simulated[0]:
        raise ReplayError(
            f"Expected a solution that can be carried out in {instance.name}, but its start is "
            "unreachable or overlaps the scene; choose another."
        )
    env = gym.make(instance.task, render_mode=render_mode, instance=instance)
    shown = play(env, batch)
    return replace(shown, success=shown.success and bool(batch.valid[0]))
