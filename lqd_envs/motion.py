"""The motion primitive: from nine numbers to a start configuration and 75 actions."""

from dataclasses import dataclass

import mujoco
import numpy as np
from mujoco.batch import Batch
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

from lqd_envs.action import ACTION_DIM, CONTROL_STEP
from lqd_envs.inputs import checked_threads
from lqd_envs.kinematics import ArmKinematics, Configurations
from lqd_envs.scene import Scene, load_scene
from lqd_envs.scenes.panda import FINGER_OPEN, FINGER_SQUEEZE
from lqd_envs.solution_space import MOTION_UNIT, POSITION_UNIT, SolutionSpace
from lqd_envs.tasks.registry import get_task
from lqd_envs.tasks.task import Task
from lqd_envs.verdict import Verdict

CLOSING_STEPS = round(0.3 / CONTROL_STEP)
"""Control steps in which the fingers close while the arm holds still."""
MOVING_STEPS = round(1.0 / CONTROL_STEP)
"""Control steps of the straight line."""
HOLDING_STEPS = round(0.2 / CONTROL_STEP)
"""Control steps in which everything holds still at the end."""
MOTION_STEPS = CLOSING_STEPS + MOVING_STEPS + HOLDING_STEPS
"""Control steps of a motion: 75, so 76 infos."""

_POS_STAGE = int(mujoco.mjtStage.mjSTAGE_POS)


@dataclass(frozen=True)
class MotionPlan:
    """How N solutions are carried out, whatever simulates them.

    Attributes:
        verdicts: (N,) uint8: `Verdict.VALID`, or the cause of the rejection.
        starts: (N, 7) float64, arm configuration at the start, rad; zero where unreachable.
        actions: (N, 75, 8) float32, what an env's `step` is given; zero where rejected.
    """

    verdicts: NDArray[np.uint8]
    starts: Configurations
    actions: NDArray[np.float32]


def start_poses(task: Task, solutions: NDArray[np.float64]) -> tuple[NDArray[np.float64], Rotation]:
    """Return where the gripper starts.

    Args:
        task: The task whose centre the positions are relative to.
        solutions: (N, 9) solutions.

    Returns:
        positions: (N, 3) float64, m, world frame.
        rotations: N rotations of the gripper, Rz(yaw) Ry(pitch) Rx(roll).
    """
    positions = np.asarray(task.center) + POSITION_UNIT * solutions[:, 0:3]
    return positions, Rotation.from_euler("xyz", solutions[:, 3:6])


def plan_motions(task: Task | str, solutions: ArrayLike, *, threads: int = 0) -> MotionPlan:
    """Find each solution's start and actions, without simulating them.

    Args:
        task: A task or its id.
        solutions: (N, 9) feasible solutions.
        threads: Threads to use; 0: one for each CPU. The result does not depend on it.

    Raises:
        SolutionError: `solutions` has another shape, a number that is not finite, or a row
            outside the space.
        UnknownTaskError: There is no task of that id.
        LQDError: `threads` is no whole number from 0 on.
    """
    found = get_task(task) if isinstance(task, str) else task
    return plan_in_scene(load_scene(found), solutions, threads=checked_threads(threads))


def plan_in_scene(scene: Scene, solutions: ArrayLike, *, threads: int = 0) -> MotionPlan:
    """Find each solution's start and actions, and reject those that have no start.

    The fingers close in 0.3 s while the arm holds still; then the gripper moves in a straight
    line at constant orientation for 1 s, starting and ending at rest (minimum jerk), and holds
    still for 0.2 s. A line that leaves the arm's reach is followed as closely as its limits allow.

    Args:
        scene: The task's scene.
        solutions: (N, 9) feasible solutions.
        threads: Threads to use; 0: one for each CPU. The result does not depend on it.

    Raises:
        SolutionError: `solutions` has another shape, a number that is not finite, or a row
            outside the space.
    """
    checked = SolutionSpace().require_feasible(solutions)
    kinematics = ArmKinematics(threads=threads)
    starts, reached = kinematics.reach(*start_poses(scene.task, checked))
    verdicts = np.where(reached, Verdict.VALID, Verdict.UNREACHABLE).astype(np.uint8)
    rows = np.flatnonzero(reached)
    verdicts[rows[overlaps(scene, starts[rows], threads=threads)]] = Verdict.OVERLAPPING

    rows = np.flatnonzero(verdicts == Verdict.VALID)
    offsets = MOTION_UNIT * checked[rows, None, 6:9] * _progress()[:, None]
    lines = kinematics.follow(starts[rows], offsets)
    actions = np.zeros((len(checked), MOTION_STEPS, ACTION_DIM), dtype=np.float32)
    actions[rows] = _actions(scene, starts[rows], lines)
    starts[~reached] = 0.0
    return MotionPlan(verdicts=verdicts, starts=starts, actions=actions)


def overlaps(scene: Scene, starts: Configurations, *, threads: int = 0) -> NDArray[np.bool_]:
    """Return which start configurations make robot and scene interpenetrate.

    Args:
        scene: The task's scene.
        starts: (N, 7) arm configurations, rad; the fingers are open.
        threads: Threads to use; 0: one for each CPU.

    Returns:
        (N,) bool.
    """
    if not len(starts):
        return np.zeros(0, dtype=bool)
    batch = Batch(scene.physics, len(starts), threads)
    sensordata = batch.bind("sensordata")
    batch.bind("qpos")[:] = scene.start_qpos(starts)
    batch.forward(stage=_POS_STAGE)
    return scene.sensors.robot_touches(sensordata)


def _progress() -> NDArray[np.float64]:
    """Return (50,) float64: the share of the line that is done at each of its control steps."""
    t = np.arange(1, MOVING_STEPS + 1) / MOVING_STEPS
    return t**3 * (10.0 - 15.0 * t + 6.0 * t**2)


def _actions(scene: Scene, starts: Configurations, lines: Configurations) -> NDArray[np.float32]:
    closing = np.repeat(starts[:, None], CLOSING_STEPS, axis=1)
    holding = np.repeat(lines[:, -1:], HOLDING_STEPS, axis=1)
    targets = np.concatenate([closing, lines, holding], axis=1)
    # At once, the fingers would snap shut at 3 m/s and sink into whatever is between them.
    ramp = np.linspace(FINGER_OPEN, FINGER_SQUEEZE, CLOSING_STEPS + 1)[1:]
    fingers = np.pad(ramp, (0, MOVING_STEPS + HOLDING_STEPS), mode="edge")
    return scene.action_map.actions(
        targets, finger_target=np.broadcast_to(fingers, targets.shape[:2])
    )
