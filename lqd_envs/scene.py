"""A task's compiled scene, with what is needed to drive it and to read it."""

import math
from dataclasses import dataclass, replace
from functools import cache, lru_cache

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

from lqd_envs.action import CONTROL_STEP, ActionMap
from lqd_envs.errors import LQDError
from lqd_envs.scenes.looks import without_looks
from lqd_envs.scenes.panda import ARM_JOINTS, FINGER_JOINTS, FINGER_OPEN, HOME
from lqd_envs.scenes.sensors import SensorReader, add_sensors
from lqd_envs.tasks.registry import TASKS
from lqd_envs.tasks.task import Task

_SETTLING_TIME = 2.0
# A compiled scene takes 26 MB, and there are as many instances of a task as one cares to draw.
_KEPT_VARIANTS = 8


@dataclass(frozen=True)
class Scene:
    """One task's compiled model and the readings of it; shared, so never to be changed.

    Attributes:
        task: The task.
        model: The compiled scene.
        physics: The same without the geoms that are only seen, to simulate faster, bit for bit.
        sensors: Reads perception from `sensordata`.
        action_map: Turns actions into controls.
        substeps: Physics steps in one control step.
        arm_qpos: (7,) addresses of the arm's joints in `qpos`.
        arm_qvel: (7,) addresses of the arm's joints in `qvel`.
        finger_qpos: (2,) addresses of the fingers' joints in `qpos`.
        rest: (nq,) joint positions with the object at rest; the robot's are not meant.
    """

    task: Task
    model: mujoco.MjModel
    physics: mujoco.MjModel
    sensors: SensorReader
    action_map: ActionMap
    substeps: int
    arm_qpos: NDArray[np.intp]
    arm_qvel: NDArray[np.intp]
    finger_qpos: NDArray[np.intp]
    rest: NDArray[np.float64]

    def start_qpos(self, arm: ArrayLike) -> NDArray[np.float64]:
        """Return start positions of all joints: the arm's as given, open fingers, object at rest.

        Args:
            arm: (..., 7) arm configurations in rad.

        Returns:
            (..., nq) float64.
        """
        configurations = np.asarray(arm, dtype=np.float64)
        qpos = np.tile(self.rest, (*configurations.shape[:-1], 1))
        qpos[..., self.arm_qpos] = configurations
        qpos[..., self.finger_qpos] = FINGER_OPEN
        return qpos


def load_scene(task: Task, *, physics_step: float | None = None) -> Scene:
    """Return the scene of a task.

    A registered task's is compiled once a process; of variants of it, such as its instances, the
    latest few are kept. A variant that has the registered task's own scene shares it.

    Args:
        task: The task.
        physics_step: Physics step in s instead of the scene's own, to measure what it changes.

    Raises:
        LQDError: The physics step does not divide the control step of 20 ms.
        InstanceError: An obstacle of the scene touches the object at the start.
    """
    registered = TASKS.get(task.id, task)
    if registered == task:
        return _load_for_good(task, physics_step=physics_step)
    if _is_seen_alike(registered, task):
        return replace(_load_for_good(registered, physics_step=physics_step), task=task)
    return _load_lately(task, physics_step=physics_step)


def _is_seen_alike(task: Task, other: Task) -> bool:
    return (task.build_scene, task.schema, task.base, task.fast_points) == (
        other.build_scene,
        other.schema,
        other.base,
        other.fast_points,
    )


def _compile_scene(task: Task, *, physics_step: float | None) -> Scene:
    spec = task.build_scene()
    add_sensors(spec, schema=task.schema, base=task.base, fast_points=task.fast_points)
    if physics_step is not None:
        spec.option.timestep = physics_step
    model = spec.compile()
    substeps = _substeps(model.opt.timestep)
    sensors = SensorReader.of(model, schema=task.schema)
    if sensors.sees_obstacles:
        # Here, since the package of the instances imports this module.
        from lqd_envs.instances.object_clearance import require_object_clear

        require_object_clear(model, base=task.base)

    def addresses(attribute: str, joints: tuple[str, ...]) -> NDArray[np.intp]:
        return np.array([getattr(model.joint(name), attribute)[0] for name in joints], np.intp)

    return Scene(
        task=task,
        model=model,
        physics=without_looks(spec, model),
        sensors=sensors,
        action_map=ActionMap.of(model),
        substeps=substeps,
        arm_qpos=addresses("qposadr", ARM_JOINTS),
        arm_qvel=addresses("dofadr", ARM_JOINTS),
        finger_qpos=addresses("qposadr", FINGER_JOINTS),
        rest=_settled(model),
    )


_load_for_good = cache(_compile_scene)
_load_lately = lru_cache(maxsize=_KEPT_VARIANTS)(_compile_scene)


def _substeps(timestep: float) -> int:
    substeps = round(CONTROL_STEP / timestep) if math.isfinite(timestep) and timestep > 0.0 else 0
    if not math.isclose(substeps * timestep, CONTROL_STEP, rel_tol=1e-9):
        raise LQDError(
            f"expected a physics step that divides the control step of {1e3 * CONTROL_STEP:g} ms, "
            f"got {1e3 * timestep:g} ms: set the scene's `option.timestep` to a whole part of it, "
            "such as 0.0025 s"
        )
    return substeps


def _settled(model: mujoco.MjModel) -> NDArray[np.float64]:
    """Return start positions in which a free object has sunk as far as its weight presses it.

    Only its height is taken: at the start its orientation is zero.
    """
    rest: NDArray[np.float64] = model.qpos0.copy()
    free = np.flatnonzero(model.jnt_type == int(mujoco.mjtJoint.mjJNT_FREE))
    if not len(free):
        return rest
    data = mujoco.MjData(model)
    for actuator, (name, position) in enumerate(zip(ARM_JOINTS, HOME, strict=True)):
        data.qpos[model.joint(name).qposadr[0]] = position
        data.ctrl[actuator] = position
    mujoco.mj_step(model, data, nstep=round(_SETTLING_TIME / model.opt.timestep))
    for joint in free:
        height = model.jnt_qposadr[joint] + 2
        rest[height] = data.qpos[height]
    return rest
