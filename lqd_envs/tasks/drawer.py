"""The task `LQD/Drawer-v0`: open the drawer."""

import numpy as np
from numpy.typing import NDArray

from lqd_envs.perception import Columns, ObjectJoint, PerceptionSchema
from lqd_envs.scenes.chest import (
    DRAWER_RANGE,
    FRONT_HEIGHT,
    FRONT_X,
    HANDLE_GAP,
    build_chest_scene,
)
from lqd_envs.solution_space import POSITION_UNIT
from lqd_envs.tasks.nearness import approach_and_progress
from lqd_envs.tasks.task import GroundTruth, Task

OPEN_DISTANCE = 0.10
"""How far out the drawer must be, in m."""

_CENTER = (FRONT_X, 0.0, FRONT_HEIGHT)
_CELL = 0.01


def _drawer_is_open(columns: Columns) -> NDArray[np.bool_]:
    return np.asarray(columns.joint_positions[:, -1, 0] >= OPEN_DISTANCE)


def _nearness_to_open(columns: Columns) -> NDArray[np.float64]:
    opening = columns.joint_positions[:, -1, 0]
    handle = np.stack(
        [
            FRONT_X - HANDLE_GAP - opening,
            np.zeros_like(opening),
            np.full_like(opening, FRONT_HEIGHT),
        ],
        axis=-1,
    )
    return approach_and_progress(
        columns.gripper_position[:, -1], target=handle, progress=opening / OPEN_DISTANCE
    )


def _gripper_at_the_start(columns: Columns) -> NDArray[np.float64]:
    return columns.gripper_position[:, 0]


DRAWER = Task(
    id="LQD/Drawer-v0",
    instruction="Open the drawer at least 10cm",
    schema=PerceptionSchema(
        base="chest of drawers, the middle of its bottom",
        fixed=True,
        links=("body", "drawer"),
        joints=(ObjectJoint(name="drawer", unit="m", upper=DRAWER_RANGE),),
    ),
    center=_CENTER,
    build_scene=build_chest_scene,
    base="body",
    fast_points=("drawer_handle",),
    success=_drawer_is_open,
    nearness=_nearness_to_open,
    ground_truth=GroundTruth(
        descriptor=_gripper_at_the_start,
        names=tuple(f"gripper {axis} at the start (m)" for axis in "xyz"),
        dims=(round(2 * POSITION_UNIT / _CELL),) * 3,
        ranges=tuple((middle - POSITION_UNIT, middle + POSITION_UNIT) for middle in _CENTER),
    ),
)
