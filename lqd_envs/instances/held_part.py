"""The predicate that the mug is held by a certain part of it."""

from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from lqd_envs.instances.instance_error import InstanceError
from lqd_envs.instances.numbers import checked_band
from lqd_envs.perception import Columns
from lqd_envs.scenes.mug import HANDLE_REACH, MUG_RADIUS, WALL
from lqd_envs.tasks.grasp import MUG_SCHEMA
from lqd_envs.tasks.task import Task

_LOWEST, _HIGHEST = -0.05, 0.15
# Beyond the middle of the handle's opening, and no further aside than fingers that pinch it.
_HANDLE_FROM = MUG_RADIUS + HANDLE_REACH / 2
_HANDLE_ASIDE = 0.025
# Fingers that close across the handle hold it from the wall on: the mug between them would be
# wider than a gripper opens.
_ACROSS_ASIDE = 0.015
_ACROSS = 0.2
_WALL_RADIUS = MUG_RADIUS - WALL / 2
_WALL_TOLERANCE = 0.012
_AXIS_TOLERANCE = 0.010
# Fingertips that still reach the wall from beside the mug.
_BODY_RADIUS = MUG_RADIUS + 0.025


@dataclass(frozen=True)
class HeldPart:
    """The mug is held by its handle, by its rim or by its body at the end of the motion.

    It is read from where the point midway between the fingertips is in the mug's frame, and from
    the direction in which the fingers close there: the mug's links do not tell. By the handle:
    the point lies beyond the middle of the handle's opening, or anywhere between it and the wall
    with fingers that close across it. By the rim: one finger is inside the mug and one outside, so
    the wall is midway between them. By the body: the mug's axis is, and the mug is in reach. A
    motion that is no grasp may hold any of them, since the task's own success is asked beside it.

    Attributes:
        part: `"handle"`, `"rim"` or `"body"`.
        low: Least height of that point above the mug's bottom, along the mug's axis, m.
        high: Greatest height, m.
        kind: Tells predicates apart in JSON.
    """

    part: str
    low: float = _LOWEST
    high: float = _HIGHEST
    kind: Literal["held_part"] = field(default="held_part", init=False)

    def __post_init__(self) -> None:
        if not isinstance(self.part, str) or self.part not in _PARTS:
            raise InstanceError(
                f"Expected a part of the mug, but got {self.part!r}; choose one of "
                f"{', '.join(_PARTS)}."
            )
        low, high = checked_band(self, low="low", high="high", within=(_LOWEST, _HIGHEST))
        object.__setattr__(self, "low", low)
        object.__setattr__(self, "high", high)

    def require_fits(self, task: Task) -> None:
        """Raise `InstanceError` where the task's object is not the mug."""
        if task.schema != MUG_SCHEMA:
            raise InstanceError(
                f"Expected a task with the mug, but got {task.id}; choose a predicate on its "
                "joints."
            )

    def holds(self, columns: Columns) -> NDArray[np.bool_]:
        """Return (N,) bool: whether the fingers are at that part at the last moment."""
        if not len(columns.gripper_position):
            return np.zeros(0, dtype=bool)
        mug = Rotation.from_euler("xyz", columns.object_orientation[:, -1]).inv()
        gripper = Rotation.from_euler("xyz", columns.gripper_orientation[:, -1])
        point = mug.apply(columns.gripper_position[:, -1] - columns.object_position[:, -1])
        closing = (mug * gripper).apply((0.0, 1.0, 0.0))
        at_height = (point[:, 2] >= self.low) & (point[:, 2] <= self.high)
        return np.asarray(at_height & (_part_at(point, closing) == _PARTS[self.part]))


_PARTS = MappingProxyType({"handle": 1, "rim": 2, "body": 3})


def _part_at(point: NDArray[np.float64], closing: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return (N,) the number of the part between the fingers, 0 for none.

    Args:
        point: (N, 3) midway between the fingertips, m, in the mug's frame.
        closing: (N, 3) unit vector along which the fingers close, in the mug's frame.
    """
    aside = np.abs(point[:, 0])
    handle = (point[:, 1] >= _HANDLE_FROM) & (aside <= _HANDLE_ASIDE)
    across = np.abs(closing[:, 1]) <= _ACROSS
    handle |= across & (point[:, 1] >= MUG_RADIUS) & (aside <= _ACROSS_ASIDE)
    # How far the mug's axis is from the plane midway between the fingers.
    off_axis = np.abs((point[:, :2] * closing[:, :2]).sum(axis=1))
    rim = np.abs(off_axis - _WALL_RADIUS) <= _WALL_TOLERANCE
    near = np.hypot(point[:, 0], point[:, 1]) <= _BODY_RADIUS
    body = near & (off_axis <= _AXIS_TOLERANCE)
    return np.select([handle, rim, body], [_PARTS["handle"], _PARTS["rim"], _PARTS["body"]], 0)
