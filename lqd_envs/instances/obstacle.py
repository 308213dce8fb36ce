"""A box that stands or floats in the scene."""

import math
from dataclasses import dataclass

from lqd_envs.instances.numbers import checked_number, checked_numbers


@dataclass(frozen=True)
class Obstacle:
    """A box that does not move, and that the robot must not touch.

    Attributes:
        position: Its centre, m, world frame.
        half_size: Half of its length along each of its own axes, m.
        yaw: How far it is turned about the vertical, rad.
    """

    position: tuple[float, float, float]
    half_size: tuple[float, float, float]
    yaw: float = 0.0

    def __post_init__(self) -> None:
        position = checked_numbers(self.position, name="`position`", length=3, within=(-2.0, 2.0))
        size = checked_numbers(self.half_size, name="`half_size`", length=3, within=(0.001, 1.0))
        yaw = checked_number(self.yaw, name="`yaw`", within=(-2.0 * math.pi, 2.0 * math.pi))
        object.__setattr__(self, "position", position)
        object.__setattr__(self, "half_size", size)
        object.__setattr__(self, "yaw", yaw)
