"""The rollouts of a report: motions of an archive, simulated once more and kept as poses."""

from typing import Any, TypedDict

import gymnasium as gym
import mujoco
import numpy as np
from numpy.typing import NDArray

from lqd_envs import Infos, Task, Trajectories, rollout
from lqd_search.evaluation.motion_evaluator import DIGEST, EXPERT, GROUND_TRUTH
from lqd_search.report.numbers import rounded, whole
from lqd_search.report.scene_parts import STEP, Part, moving_bodies, scene_parts
from lqd_search.runs.replay import carry_out, perceived
from lqd_search.runs.stored_archive import StoredArchive


class Rollout(TypedDict):
    """One motion.

    `poses` holds, for each of its 76 moments and each body that moves, position (m) and quaternion
    (w first) in the world frame, in units of `STEP`. `same` says whether what is perceived in them
    is, bit for bit, what the run saw.
    """

    elite: int
    evaluation: int
    fitness: float | None
    success: bool
    expert: bool
    ground_truth: list[float | None]
    solution: list[float | None]
    same: bool
    poses: list[int]


class Stage(TypedDict):
    """The scene that rollouts of one task are shown in; poses are of these bodies, in order."""

    bodies: list[int]
    parts: list[Part]


def stage_of(task: Task) -> Stage:
    """Return the scene of a task."""
    env = gym.make(task.id)
    try:
        model, _ = _simulation(env)
        # Not by a reset: the usual start may be one that is refused.
        data = mujoco.MjData(model)
        mujoco.mj_kinematics(model, data)
        return {"bodies": moving_bodies(model).tolist(), "parts": scene_parts(model, data)}
    finally:
        env.close()


def rollouts_of(task: Task, archive: StoredArchive, *, elites: NDArray[np.int64]) -> list[Rollout]:
    """Simulate elites of an archive.

    One whose start is rejected here, since it was found by another version, is left out.

    Args:
        task: The task that they were found for.
        archive: Where they are kept.
        elites: (k,) their rows.
    """
    if not len(elites):
        return []
    trajectories = rollout(task, archive.fields["solution"][elites])
    digests = trajectories.digests()
    env = gym.make(task.id)
    try:
        shown = []
        for row, elite in enumerate(elites.tolist()):
            if trajectories.simulated[row]:
                poses, infos = _played(env, trajectories, row)
                # The poses are the env's, the digest is the batch's: so that the two are compared.
                same = infos == trajectories.infos(row)
                same &= bool(digests[row] == archive.fields[DIGEST][elite])
                shown.append(_rollout(archive, elite, poses=poses, same=same))
        return shown
    finally:
        env.close()


def _rollout(
    archive: StoredArchive, elite: int, *, poses: NDArray[np.float64], same: bool
) -> Rollout:
    fields = archive.fields
    return {
        "elite": elite,
        "evaluation": int(fields["evaluation"][elite]),
        "fitness": rounded(fields["objective"][[elite]])[0],
        "success": bool(fields["success"][elite]),
        "expert": bool(fields[EXPERT][elite]),
        "ground_truth": rounded(fields[GROUND_TRUTH][elite], digits=4),
        "solution": rounded(fields["solution"][elite], digits=4),
        "same": same,
        "poses": whole(poses, step=STEP),
    }


def _played(
    env: gym.Env[Any, Any], trajectories: Trajectories, row: int
) -> tuple[NDArray[np.float64], Infos]:
    """Return (76, b, 7) poses of the bodies that move, and what is perceived at these moments."""
    model, data = _simulation(env)
    bodies = moving_bodies(model)
    plan = trajectories.plan
    poses, infos = [], []
    for info in carry_out(env, plan.starts[row], plan.actions[row]):
        poses.append(_pose(data, bodies))
        infos.append(perceived(info))
    return np.stack(poses), infos


def _pose(data: mujoco.MjData, bodies: NDArray[np.int64]) -> NDArray[np.float64]:
    return np.concatenate([data.xpos[bodies], data.xquat[bodies]], axis=1)


def _simulation(env: gym.Env[Any, Any]) -> tuple[mujoco.MjModel, mujoco.MjData]:
    unwrapped: Any = env.unwrapped
    return unwrapped.model, unwrapped.data
