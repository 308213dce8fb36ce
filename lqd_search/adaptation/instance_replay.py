"""Carrying out one solution in an instance, step by step, in the single Gymnasium env."""

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from lqd_envs import Info, get_task, rollout
from lqd_envs.instances import Instance
from lqd_search.runs.replay import Frame, Replay, ReplayError


def replay_in(
    instance: Instance, solution: NDArray[np.float64], *, render_mode: str | None = None
) -> Replay:
    """Carry out one solution in the env of an instance.

    Args:
        instance: The instance.
        solution: (9,) the solution.
        render_mode: `"rgb_array"` to collect frames, `"human"` to watch, or None.

    Returns:
        What it showed; `success` says whether the instance was solved, the env's word at the end,
        or False where the motion failed in the batch rollout, which alone looks at that.

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
    infos: list[Info] = []
    frames: list[Frame] = []
    success = False
    env = gym.make(instance.task, render_mode=render_mode, instance=instance)
    try:
        _, info = env.reset(options={"arm": batch.plan.starts[0]})
        for action in (None, *batch.plan.actions[0]):
            if action is not None:
                _, _, _, _, info = env.step(action)
            success = bool(info.pop("is_success"))
            infos.append(info)  # type: ignore[arg-type] # without it, it is an Info
            if render_mode == "rgb_array":
                frames.append(np.asarray(env.render()))
    finally:
        env.close()
    return Replay(
        infos=infos,
        success=success and bool(batch.valid[0]),
        same_as_batch=infos == batch.infos(0),
        digest=int(batch.digests()[0]),
        frames=tuple(frames),
    )
