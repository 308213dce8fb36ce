"""Simulating a batch of motions, with no Python in the physics loop."""

from collections.abc import Callable

import mujoco
import numpy as np
from mujoco.batch import Batch
from numpy.typing import ArrayLike, NDArray

from lqd_envs.discarded import too_deep, too_fast
from lqd_envs.inputs import checked_threads
from lqd_envs.motion import MOTION_STEPS, MotionPlan, plan_in_scene
from lqd_envs.scene import Scene, load_scene
from lqd_envs.solution_space import SolutionSpace
from lqd_envs.tasks.registry import get_task
from lqd_envs.tasks.task import Task
from lqd_envs.trajectories import Trajectories
from lqd_envs.verdict import Verdict

# Bounds the memory of the records, which hold every physics step: about 100 kB a motion.
_CHUNK = 512


PrepareBatch = Callable[[Batch, NDArray[np.intp]], None]
"""Changes simulations before they run: is given a batch at its start, and the rows it holds."""


def rollout(task: Task | str, solutions: ArrayLike, *, threads: int = 0) -> Trajectories:
    """Carry out a batch of solutions.

    Each motion starts from the scene's start state. Its row of the result is the same, bit for
    bit, whatever the other rows are, at any number of threads, and as the single env gives it
    for the same start and actions.

    Args:
        task: A task or its id.
        solutions: (N, 9) feasible solutions.
        threads: Threads to use; 0: one for each CPU.

    Returns:
        The motions' perception and verdicts.

    Raises:
        SolutionError: `solutions` has another shape, a number that is not finite, or a row
            outside the space.
        UnknownTaskError: There is no task of that id.
        LQDError: `threads` is no whole number from 0 on.
    """
    threads = checked_threads(threads)
    scene = load_scene(get_task(task) if isinstance(task, str) else task)
    checked = SolutionSpace().require_feasible(solutions)
    return simulate(scene, checked, plan_in_scene(scene, checked, threads=threads), threads=threads)


def simulate(
    scene: Scene,
    solutions: NDArray[np.float64],
    plan: MotionPlan,
    *,
    threads: int = 0,
    prepare: PrepareBatch | None = None,
) -> Trajectories:
    """Simulate the motions of a plan that were not rejected.

    Args:
        scene: The task's scene.
        solutions: (N, 9) solutions that the plan was made for.
        plan: Their starts and actions.
        threads: Threads to use; 0: one for each CPU.
        prepare: Changes the simulations, such as where the object stands, before they run.
    """
    rows = np.flatnonzero(plan.verdicts == Verdict.VALID)
    sensordata = np.empty((len(rows), MOTION_STEPS + 1, scene.model.nsensordata))
    warned = np.empty(len(rows), dtype=bool)
    obstructed = np.zeros(len(solutions), dtype=bool)
    for start in range(0, len(rows), _CHUNK):
        chunk = slice(start, start + _CHUNK)
        sensordata[chunk], warned[chunk] = _simulate_chunk(
            scene, plan, rows[chunk], threads=threads, prepare=prepare
        )
    verdicts = plan.verdicts.copy()
    verdicts[rows] = _judge(scene, sensordata, warned)
    obstructed[rows] = scene.sensors.robot_touches_obstacle(sensordata).any(axis=1)
    return Trajectories(
        task=scene.task,
        solutions=solutions,
        plan=plan,
        verdicts=verdicts,
        columns=scene.sensors.columns(sensordata).spread(rows, n=len(solutions)),
        obstructed=obstructed if scene.sensors.sees_obstacles else None,
    )


def _simulate_chunk(
    scene: Scene,
    plan: MotionPlan,
    rows: NDArray[np.intp],
    *,
    threads: int,
    prepare: PrepareBatch | None,
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Return (n, 76, nsensordata) sensor values and (n,) whether the simulation warned."""
    batch = Batch(scene.physics, len(rows), threads)
    # From the model's defaults on: a state that was only overwritten keeps warm-start values.
    batch.reset(stage=int(mujoco.mjtStage.mjSTAGE_NONE))
    batch.bind("qpos")[:] = scene.start_qpos(plan.starts[rows])
    if prepare is not None:
        prepare(batch, rows)
    controls = np.repeat(scene.action_map.controls(plan.actions[rows]), scene.substeps, axis=1)
    # Sensors describe the state before their step, so the last state needs one step more.
    controls = np.concatenate([controls, controls[:, -1:]], axis=1)
    record = batch.rollout(controls.shape[1], control=controls, record=("sensordata",))
    warned = batch.warning[:, :, 1].sum(axis=1) > 0
    return record["sensordata"][:, :: scene.substeps], warned


def _judge(
    scene: Scene, sensordata: NDArray[np.float64], warned: NDArray[np.bool_]
) -> NDArray[np.uint8]:
    deep = too_deep(scene.sensors, sensordata).any(axis=1)
    fast = too_fast(scene.sensors, sensordata).any(axis=1)
    causes = [Verdict.DIVERGED, Verdict.PENETRATING, Verdict.TOO_FAST]
    return np.select([warned, deep, fast], causes, Verdict.VALID).astype(np.uint8)
