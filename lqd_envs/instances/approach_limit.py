"""A limit on the direction that the gripper comes from."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from lqd_envs.instances.instance_error import InstanceError
from lqd_envs.instances.numbers import HALF_ANGLES, checked_number, checked_numbers
from lqd_envs.perception import Columns

_SHORTEST = 1e-6


@dataclass(frozen=True)
class ApproachLimit:
    """The fingers must point into a cone at the start of the motion.

    A motion primitive keeps its orientation, so what holds at its start holds for all of it, but
    for what contacts turn.

    Attributes:
        direction: The cone's axis, world frame: where the fingers should point. (0, 0, -1) is
            straight down, (1, 0, 0) away from the robot, (0, 1, 0) to its left. Any length.
        half_angle: Largest angle between the two, rad.
    """

    direction: tuple[float, float, float]
    half_angle: float

    def __post_init__(self) -> None:
        direction = checked_numbers(
            self.direction, name="`direction`", length=3, within=(-1e3, 1e3)
        )
        if math.hypot(*direction) < _SHORTEST:
            raise InstanceError(
                f"Expected a `direction` of some length, but got {direction}; give a vector that "
                "points somewhere."
            )
        half_angle = checked_number(self.half_angle, name="`half_angle`", within=HALF_ANGLES)
        object.__setattr__(self, "direction", direction)
        object.__setattr__(self, "half_angle", half_angle)

    def holds(self, columns: Columns) -> NDArray[np.bool_]:
        """Return (N,) bool: whether the fingers point into the cone at the first moment."""
        axis = np.array(self.direction) / math.hypot(*self.direction)
        fingers = pointing(columns.gripper_orientation[:, 0])
        return np.asarray(fingers @ axis >= math.cos(self.half_angle))


def pointing(orientation: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return where the fingers of a gripper point.

    Args:
        orientation: (N, 3) roll, pitch and yaw of the gripper, rad.

    Returns:
        (N, 3) float64 unit vectors, world frame: Rz(yaw) Ry(pitch) Rx(roll) (0, 0, -1).
    """
    roll, pitch, yaw = orientation.T
    # The last column of the rotation matrix, turned round.
    tilted, raised = np.sin(pitch) * np.cos(roll), np.sin(roll)
    return -np.stack(
        [
            np.cos(yaw) * tilted + np.sin(yaw) * raised,
            np.sin(yaw) * tilted - np.cos(yaw) * raised,
            np.cos(pitch) * np.cos(roll),
        ],
        axis=-1,
    )
