"""What the objects of the scenes are made of: solids that the robot touches, and dry joints."""

from typing import Any

from lqd_envs.scenes.panda import ROBOT_BIT

_CONTACT_TIME = 0.01
_HARD_STOP = {"solref_limit": (0.01, 1.0), "solimp_limit": (0.95, 0.999, 0.001, 0.5, 2.0)}
_HARD_FRICTION = {"solref_friction": (0.01, 1.0), "solimp_friction": (0.99, 0.999, 0.001, 0.5, 2.0)}


def solid(material: str, *, friction: float) -> dict[str, Any]:
    """Return the attributes of a geom that the robot can touch, and nothing else can.

    Args:
        material: Name of a material of the scene.
        friction: Sliding friction; of two surfaces that touch, the higher one counts.
    """
    return {
        "material": material,
        "contype": 0,
        "conaffinity": ROBOT_BIT,
        "condim": 4,
        "friction": (friction, 0.005, 0.0001),
        "solref": (_CONTACT_TIME, 1.0),
        "group": 2,
    }


def dry_joint(upper: float, *, friction: float) -> dict[str, Any]:
    """Return the attributes of a joint from 0 to `upper` that stays where it is left.

    With MuJoCo's defaults an arm pushes such a joint several degrees past its stop, and it creeps
    under half of the load that its friction should hold.

    Args:
        upper: Position at which it is fully open, in rad or m.
        friction: What it resists with, in N m or N.
    """
    return {
        "range": (0.0, upper),
        "limited": True,
        "frictionloss": friction,
        **_HARD_STOP,
        **_HARD_FRICTION,
    }
