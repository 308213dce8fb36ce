"""A task of one's own: switch on the light. docs/tutorials/own-task.md explains it."""

# Before mujoco, so that pictures can be drawn without a display.
from lqd_envs import Columns, GroundTruth, ObjectJoint, PerceptionSchema, Task, register_task

# isort: split
import mujoco
import numpy as np
from numpy.typing import NDArray

from lqd_envs.scenes.parts import dry_joint, solid
from lqd_envs.scenes.workspace import new_workspace
from lqd_envs.tasks.nearness import approach_and_progress

PANEL = (0.55, 0.0, 0.16)
"""Middle of the panel's front, where the lever's hinge is, in m, world frame."""
LEVER_LENGTH = 0.07
"""Length of the lever in m."""
LEVER_RANGE = 1.0
"""Angle from off, where the lever points down, to fully on, in rad."""
ON_ANGLE = 0.6
"""Angle from which on the light is on, in rad."""


def build_light_switch_scene() -> mujoco.MjSpec:
    """Return the scene: robot, table and a light switch on a stand that faces the robot."""
    spec = new_workspace("light switch")
    spec.add_material(name="ivory", rgba=(0.90, 0.88, 0.80, 1.0), specular=0.3, shininess=0.4)
    spec.add_material(name="signal", rgba=(0.85, 0.45, 0.12, 1.0), specular=0.4, shininess=0.4)

    stand = spec.worldbody.add_body(name="stand", pos=(PANEL[0], PANEL[1], 0.0))
    stand.add_geom(
        type=mujoco.mjtGeom.mjGEOM_BOX,
        pos=(0.02, 0.0, 0.12),
        size=(0.02, 0.06, 0.12),
        **solid("ivory", friction=0.8),
    )

    lever = stand.add_body(name="lever", pos=(0.0, 0.0, PANEL[2]))
    lever.add_joint(
        name="lever",
        type=mujoco.mjtJoint.mjJNT_HINGE,
        axis=(0.0, 1.0, 0.0),
        **dry_joint(LEVER_RANGE, friction=0.1),
        damping=0.01,
        armature=0.0005,
    )
    down = -LEVER_RANGE / 2
    tip = (-LEVER_LENGTH * np.cos(down), 0.0, LEVER_LENGTH * np.sin(down))
    lever.add_geom(
        type=mujoco.mjtGeom.mjGEOM_CAPSULE,
        fromto=(0.0, 0.0, 0.0, *tip),
        size=(0.012, 0.0, 0.0),
        mass=0.03,
        **solid("signal", friction=0.8),
    )
    lever.add_site(name="lever_tip", pos=tip, group=4)
    return spec


def light_is_on(columns: Columns) -> NDArray[np.bool_]:
    """Return (N,) bool: whether the lever is up at the end of each motion."""
    return np.asarray(columns.joint_positions[:, -1, 0] >= ON_ANGLE)


def nearness_to_on(columns: Columns) -> NDArray[np.float64]:
    """Return (N,) float64 in [0, 1]: more for a gripper near the lever and for a lever near on."""
    angle = columns.joint_positions[:, -1, 0]
    slope = angle - LEVER_RANGE / 2
    tip = np.asarray(PANEL) + LEVER_LENGTH * np.stack(
        [-np.cos(slope), np.zeros_like(slope), np.sin(slope)], axis=-1
    )
    return approach_and_progress(
        columns.gripper_position[:, -1], target=tip, progress=angle / ON_ANGLE
    )


def lever_at_the_end(columns: Columns) -> NDArray[np.float64]:
    """Return (N, 1) float64: the lever's angle at the end of each motion, in rad."""
    return np.clip(columns.joint_positions[:, -1, :1], 0.0, LEVER_RANGE)


LIGHT_SWITCH = Task(
    id="Home/LightSwitch-v0",
    instruction="Switch on the light",
    schema=PerceptionSchema(
        base="light switch, where its stand is on the table",
        fixed=True,
        links=("stand", "lever"),
        joints=(ObjectJoint(name="lever", unit="rad", upper=LEVER_RANGE),),
    ),
    center=(PANEL[0] - LEVER_LENGTH, PANEL[1], PANEL[2]),
    build_scene=build_light_switch_scene,
    base="stand",
    fast_points=("lever_tip",),
    success=light_is_on,
    nearness=nearness_to_on,
    ground_truth=GroundTruth(
        descriptor=lever_at_the_end,
        names=("lever angle at the end (rad)",),
        dims=(50,),
        ranges=((0.0, LEVER_RANGE),),
    ),
)

register_task(LIGHT_SWITCH)
