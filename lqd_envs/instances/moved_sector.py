"""The predicate that a free object was moved into a sector."""

import math
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from lqd_envs.instances.instance_error import InstanceError
from lqd_envs.instances.numbers import HALF_ANGLES, checked_band, checked_number
from lqd_envs.perception import Columns
from lqd_envs.tasks.task import Task

_FARTHEST = 2.0


@dataclass(frozen=True)
class MovedSector:
    """The object ends in a sector around where it stood, as seen from above.

    Attributes:
        direction: Middle of the sector, rad: the angle about the vertical from the world's x axis,
            which points away from the robot; a quarter turn is the robot's left.
        half_width: Largest angle between that and the way from start to end, rad.
        nearest: Least horizontal distance from the start, m.
        farthest: Greatest horizontal distance, m.
        kind: Tells predicates apart in JSON.
    """

    direction: float
    half_width: float
    nearest: float
    farthest: float
    kind: Literal["moved_sector"] = field(default="moved_sector", init=False)

    def __post_init__(self) -> None:
        direction = checked_number(
            self.direction, name="`direction`", within=(-2.0 * math.pi, 2.0 * math.pi)
        )
        half_width = checked_number(self.half_width, name="`half_width`", within=HALF_ANGLES)
        nearest, farthest = checked_band(
            self, low="nearest", high="farthest", within=(0.0, _FARTHEST)
        )
        object.__setattr__(self, "direction", direction)
        object.__setattr__(self, "half_width", half_width)
        object.__setattr__(self, "nearest", nearest)
        object.__setattr__(self, "farthest", farthest)

    def require_fits(self, task: Task) -> None:
        """Raise `InstanceError` where the task's object is fixed to the table."""
        if task.schema.fixed:
            raise InstanceError(
                f"Expected a task whose object can be moved, but got {task.id}, whose object is "
                "fixed to the table; choose a predicate on its joints."
            )

    def holds(self, columns: Columns) -> NDArray[np.bool_]:
        """Return (N,) bool: whether the object is in the sector at the last moment."""
        way = columns.object_position[:, -1, :2] - columns.object_position[:, 0, :2]
        distance = np.linalg.norm(way, axis=1)
        # The length of the way along the sector's middle, so that nothing is divided by zero.
        along = way @ np.array([math.cos(self.direction), math.sin(self.direction)])
        inside = along >= distance * math.cos(self.half_width)
        return np.asarray(inside & (distance >= self.nearest) & (distance <= self.farthest))
