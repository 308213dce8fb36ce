"""The task `LQD/Grasp-v0`: grasp the mug."""

import numpy as np
from numpy.typing import NDArray

from lqd_envs.perception import Columns, PerceptionSchema
from lqd_envs.scenes.mug import MUG_HEIGHT, MUG_POINTS, MUG_POSITION, build_mug_scene
from lqd_envs.tasks.nearness import approach_and_progress
from lqd_envs.tasks.task import GroundTruth, Task

MUG_SCHEMA = PerceptionSchema(
    base="mug, the middle of its bottom", fixed=False, links=("mug",), joints=()
)
MUG_CENTER = (*MUG_POSITION, MUG_HEIGHT / 2)
"""The mug's geometric centre at the start, in m."""

_LIFT = 0.02
_REACH = 0.20
_TOP = 0.30
_CELL = 0.01


def _mug_is_held(columns: Columns) -> NDArray[np.bool_]:
    touched, standing = columns.gripper_contacts[:, -1, 0], columns.object_table_contact[:, -1]
    return np.logical_and(touched, ~standing)


def _nearness_to_held(columns: Columns) -> NDArray[np.float64]:
    lift = columns.object_position[:, -1, 2] - columns.object_position[:, 0, 2]
    touched = columns.gripper_contacts[:, -1, 0]
    return approach_and_progress(
        columns.gripper_position[:, -1],
        target=columns.object_position[:, -1] + (0.0, 0.0, MUG_HEIGHT / 2),
        progress=(touched + np.clip(lift / _LIFT, 0.0, 1.0)) / 2.0,
    )


def _gripper_at_first_contact(columns: Columns) -> NDArray[np.float64]:
    contacts = columns.gripper_contacts[:, :, 0]
    first = contacts.argmax(axis=1)
    positions = columns.gripper_position[np.arange(len(first)), first]
    touched = np.asarray(contacts.any(axis=1))
    return np.where(touched[:, None], positions, np.nan)


GRASP = Task(
    id="LQD/Grasp-v0",
    instruction="Grasp the mug",
    schema=MUG_SCHEMA,
    center=MUG_CENTER,
    build_scene=build_mug_scene,
    base="mug",
    fast_points=MUG_POINTS,
    success=_mug_is_held,
    nearness=_nearness_to_held,
    ground_truth=GroundTruth(
        descriptor=_gripper_at_first_contact,
        names=tuple(f"gripper {axis} at the first contact (m)" for axis in "xyz"),
        dims=(round(2 * _REACH / _CELL), round(2 * _REACH / _CELL), round(_TOP / _CELL)),
        ranges=(
            (MUG_POSITION[0] - _REACH, MUG_POSITION[0] + _REACH),
            (MUG_POSITION[1] - _REACH, MUG_POSITION[1] + _REACH),
            (0.0, _TOP),
        ),
    ),
)
