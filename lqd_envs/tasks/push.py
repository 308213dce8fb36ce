"""The task `LQD/Push-v0`: slide the mug on the table."""

import numpy as np
from numpy.typing import NDArray

from lqd_envs.perception import Columns
from lqd_envs.scenes.mug import MUG_HEIGHT, MUG_POINTS, MUG_POSITION, build_mug_scene
from lqd_envs.tasks.grasp import MUG_CENTER, MUG_SCHEMA
from lqd_envs.tasks.nearness import approach_and_progress
from lqd_envs.tasks.task import GroundTruth, Task

PUSH_DISTANCE = 0.05
"""How far the mug's base must be from where it stood, horizontally, in m."""

_REACH = 0.30
_CELL = 0.02


def _mug_was_slid(columns: Columns) -> NDArray[np.bool_]:
    way = columns.object_position[:, -1, :2] - columns.object_position[:, 0, :2]
    far = np.linalg.norm(way, axis=1) >= PUSH_DISTANCE
    return np.asarray(far & columns.object_table_contact[:, -1])


def _nearness_to_slid(columns: Columns) -> NDArray[np.float64]:
    way = columns.object_position[:, -1, :2] - columns.object_position[:, 0, :2]
    return approach_and_progress(
        columns.gripper_position[:, -1],
        target=columns.object_position[:, -1] + (0.0, 0.0, MUG_HEIGHT / 2),
        progress=np.linalg.norm(way, axis=1) / PUSH_DISTANCE,
    )


def _mug_at_the_end(columns: Columns) -> NDArray[np.float64]:
    return columns.object_position[:, -1, :2]


PUSH = Task(
    id="LQD/Push-v0",
    instruction="Slide the mug on the table at least 5cm",
    schema=MUG_SCHEMA,
    center=MUG_CENTER,
    build_scene=build_mug_scene,
    base="mug",
    fast_points=MUG_POINTS,
    success=_mug_was_slid,
    nearness=_nearness_to_slid,
    ground_truth=GroundTruth(
        descriptor=_mug_at_the_end,
        names=tuple(f"mug {axis} at the end (m)" for axis in "xy"),
        dims=(round(2 * _REACH / _CELL),) * 2,
        ranges=tuple((middle - _REACH, middle + _REACH) for middle in MUG_POSITION),
    ),
)
