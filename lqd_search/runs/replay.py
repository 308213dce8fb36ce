"""Carrying out one stored solution again, step by step, in the single Gymnasium env."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, cast

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from lqd_envs import Info, Infos, LQDError, Trajectories, rollout

Frame = NDArray[np.uint8]


class ReplayError(LQDError):
    """A motion that cannot be replayed."""


@dataclass(frozen=True, eq=False)
class Replay:
    """What a replay showed.

    Attributes:
        infos: What was perceived at the 76 moments, without what else the env says of them.
        success: The expert's word at the end, from the env.
        same_as_batch: Whether these infos are, bit for bit, those of a batch rollout.
        digest: Fingerprint of the batch rollout, to be compared with the stored one.
        frames: A picture for each info, where they were asked for.
    """

    infos: Infos
    success: bool
    same_as_batch: bool
    digest: int
    frames: tuple[Frame, ...]


def replay(task: str, solution: NDArray[np.float64], *, render_mode: str | None = None) -> Replay:
    """Carry out one solution in the env of a task.

    Args:
        task: Id of the task.
        solution: (9,) the solution.
        render_mode: `"rgb_array"` to collect frames, `"human"` to watch, or None.

    Raises:
        ReplayError: The solution is rejected before it could be simulated.
        RenderingError: Pictures were asked for and cannot be drawn here.
    """
    batch = rollout(task, solution[None])
    if not batch.simulated[0]:
        raise ReplayError(
            "Expected a solution that can be carried out, but this one is rejected here: its "
            "start is unreachable or overlaps the scene; if another version found it, run the "
            "search again."
        )
    return play(gym.make(task, render_mode=render_mode), batch)


def play(env: gym.Env[Any, Any], batch: Trajectories) -> Replay:
    """Carry out the one motion of a batch rollout in an env, step by step, and close the env.

    Args:
        env: An env of the batch's task.
        batch: The rollout, of a single motion that was simulated.

    Raises:
        RenderingError: Pictures were asked for and cannot be drawn here.
    """
    try:
        infos, success, frames = _play(env, batch.plan.starts[0], batch.plan.actions[0])
    finally:
        env.close()
    return Replay(
        infos=infos,
        success=success,
        same_as_batch=infos == batch.infos(0),
        digest=int(batch.digests()[0]),
        frames=tuple(frames),
    )


def _play(
    env: gym.Env[Any, Any], start: NDArray[np.float64], actions: NDArray[np.float32]
) -> tuple[Infos, bool, list[Frame]]:
    infos: Infos = []
    frames: list[Frame] = []
    for info in carry_out(env, start, actions):
        infos.append(perceived(info))
        frames += _frame(env)
    return infos, bool(info["is_success"]), frames


def carry_out(
    env: gym.Env[Any, Any], start: NDArray[np.float64], actions: NDArray[np.float32]
) -> Iterator[Mapping[str, Any]]:
    """Carry out a motion in an env, one step for each info that is asked for.

    Args:
        env: The env.
        start: (7,) joint positions that the motion starts from, rad.
        actions: (75, 8) its actions.

    Yields:
        What the env says at the 76 moments, while it is at that moment.
    """
    _, info = env.reset(options={"arm": start})
    yield info
    for action in actions:
        _, _, _, _, info = env.step(action)
        yield info


def perceived(info: Mapping[str, Any]) -> Info:
    """Return of an env's info what is perceived, without what else the env says of it."""
    return cast(Info, {name: info[name] for name in Info.__annotations__})


def _frame(env: gym.Env[Any, Any]) -> list[Frame]:
    return [np.asarray(env.render())] if env.render_mode == "rgb_array" else []
