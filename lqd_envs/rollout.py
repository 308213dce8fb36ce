"""Simulating a batch of motions, with no Python in the physics loop."""

from collections.abc import Callable
from dataclasses import replace

import mujoco
import numpy as np
from mujoco.batch import Batch
from numpy.typing import ArrayLike, NDArray

from lqd_envs.motion import MOTION_STEPS, MotionPlan, plan_motions
from lqd_envs.perception import Columns
from lqd_envs.scene import Scene, load_scene
from lqd_envs.solution_space import SolutionSpace
from lqd_envs.tasks.registry import get_task
from lqd_envs.tasks.task import Task
from lqd_envs.trajectories import Trajectories
from lqd_envs.verdict import DEEPEST_CONTACT, FASTEST_OBJECT, Verdict

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
    """
    scene = load_scene(get_task(task) if isinstance(task, str) else task)
    checked = SolutionSpace().require_feasible(solutions)
    return simulate(scene, checked, plan_motions(scene, checked, threads=threads), threads=threads)


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
    verdicts = plan.verdicts.copy()
    rows = np.flatnonzero(verdicts == Verdict.VALID)
    sensordata = np.zeros((len(solutions), MOTION_STEPS + 1, scene.model.nsensordata))
    sensordata[..., scene.sensors.slices["gripper_orientation"].start] = 1.0
    sensordata[..., scene.sensors.slices["object_orientation"].start] = 1.0
    for chunk in np.split(rows, range(_CHUNK, len(rows), _CHUNK)):
        if len(chunk):
            sensordata[chunk], warned = _simulate_chunk(
                scene, plan, chunk, threads=threads, prepare=prepare
            )
            verdicts[chunk[warned]] = Verdict.DIVERGED
    verdicts = _discard(scene, verdicts, sensordata)
    return Trajectories(
        task=scene.task,
        solutions=solutions,
        plan=plan,
        verdicts=verdicts,
        columns=_blank_rejected(scene.sensors.columns(sensordata), plan),
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
    batch = Batch(scene.model, len(rows), threads)
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


def _discard(
    scene: Scene, verdicts: NDArray[np.uint8], sensordata: NDArray[np.float64]
) -> NDArray[np.uint8]:
    deep = scene.sensors.depth(sensordata).max(axis=1) > DEEPEST_CONTACT
    fast = scene.sensors.speed(sensordata).max(axis=1) > FASTEST_OBJECT
    still_valid = verdicts == Verdict.VALID
    causes = np.select([deep, fast], [Verdict.PENETRATING, Verdict.TOO_FAST], Verdict.VALID)
    return np.where(still_valid, causes, verdicts).astype(np.uint8)


def _blank_rejected(columns: Columns, plan: MotionPlan) -> Columns:
    simulated = plan.verdicts == Verdict.VALID
    contact = columns.object_table_contact & simulated[:, None]
    return replace(columns, object_table_contact=contact)
