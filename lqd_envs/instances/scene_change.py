"""A change of the object: where it stands, and how it resists."""

import math
from dataclasses import dataclass, fields

from lqd_envs.instances.numbers import checked_number, checked_numbers

_FARTHEST = 0.10
_LARGEST_SCALE = 100.0


@dataclass(frozen=True)
class SceneChange:
    """What is different about the object, and about surfaces, from the task's own scene.

    Attributes:
        shift: How far the object is moved in x and y, m, world frame.
        turn: How far it is turned about the vertical through the task's centre (left out of the
            shift), rad.
        contact_friction: Factor on the friction of every contact. Of two surfaces that touch the
            higher friction counts, so all surfaces are scaled, those of the fingers too.
        joint_friction: Factor on the dry friction of the object's joints.
        damping: Factor on the damping of the object's joints.
        mass: Factor on the mass and inertia of the object.
    """

    shift: tuple[float, float] = (0.0, 0.0)
    turn: float = 0.0
    contact_friction: float = 1.0
    joint_friction: float = 1.0
    damping: float = 1.0
    mass: float = 1.0

    def __post_init__(self) -> None:
        shift = checked_numbers(
            self.shift, name="`shift`", length=2, within=(-_FARTHEST, _FARTHEST)
        )
        turn = checked_number(self.turn, name="`turn`", within=(-math.pi, math.pi))
        object.__setattr__(self, "shift", shift)
        object.__setattr__(self, "turn", turn)
        for scale in fields(self)[2:]:
            value = checked_number(
                getattr(self, scale.name),
                name=f"`{scale.name}`",
                within=(1.0 / _LARGEST_SCALE, _LARGEST_SCALE),
            )
            object.__setattr__(self, scale.name, value)
