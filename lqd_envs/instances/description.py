"""What an instance asks, in words."""

import math
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any

from lqd_envs.instances.approach_limit import ApproachLimit
from lqd_envs.instances.held_part import HeldPart
from lqd_envs.instances.instance import Instance
from lqd_envs.instances.joint_band import JointBand
from lqd_envs.instances.moved_sector import MovedSector
from lqd_envs.instances.obstacle import Obstacle
from lqd_envs.instances.predicate import Predicate
from lqd_envs.instances.scene_change import SceneChange
from lqd_envs.tasks.registry import get_task
from lqd_envs.tasks.task import Task

_CM = 100.0
_ON_TABLE = 0.0005


def describe(instance: Instance) -> tuple[str, ...]:
    """Return what an instance asks beside its task's own success, a sentence for each part.

    Args:
        instance: The instance.

    Raises:
        UnknownTaskError: There is no task of its id.
        InstanceError: It does not fit its task.
    """
    task = get_task(instance.task)
    # A joint that the task's object lacks has no unit to be told in.
    instance.apply(task)
    sentences = [_obstacle(obstacle) for obstacle in instance.obstacles]
    if instance.predicate is not None:
        sentences.append(_predicate(instance.predicate, task))
    if instance.approach is not None:
        sentences.append(_approach(instance.approach))
    if instance.change is not None:
        sentences.append(_change(instance.change))
    return tuple(sentences) or ("Nothing is particular: it is the task itself.",)


def _predicate(predicate: Predicate, task: Task) -> str:
    say = _PREDICATES.get(type(predicate))
    return say(predicate, task) if say else f"At the end {predicate!r} holds."


def _joint_band(band: JointBand, task: Task) -> str:
    unit = next(joint.unit for joint in task.schema.joints if joint.name == band.joint)
    if unit == "rad":
        low, high = math.degrees(band.low), math.degrees(band.high)
        where = f"between {low:.1f}° and {high:.1f}°"
    else:
        where = f"between {band.low * _CM:.1f} and {band.high * _CM:.1f} cm"
    return f"The joint {band.joint} ends {where}."


def _moved_sector(sector: MovedSector, _: Task) -> str:
    return (
        f"The object ends {sector.nearest * _CM:.1f} to {sector.farthest * _CM:.1f} cm from where "
        f"it stood, at most {math.degrees(sector.half_width):.0f}° off {_heading(sector.direction)}"
        "."
    )


def _held_part(held: HeldPart, _: Task) -> str:
    return (
        f"The mug is held by its {held.part}, with the fingertips {held.low * _CM:.1f} to "
        f"{held.high * _CM:.1f} cm above its bottom."
    )


_PREDICATES: Mapping[type, Callable[[Any, Task], str]] = MappingProxyType(
    {JointBand: _joint_band, MovedSector: _moved_sector, HeldPart: _held_part}
)


def _approach(limit: ApproachLimit) -> str:
    x, y, z = limit.direction
    across = math.hypot(x, y)
    slope = math.degrees(math.atan2(-z, across))
    steep = f"{abs(slope):.0f}° {'below' if slope >= 0.0 else 'above'} the horizontal"
    towards = f", {_heading(math.atan2(y, x))}" if across > 1e-9 else ""
    return (
        f"At the start the fingers point at most {math.degrees(limit.half_angle):.0f}° off the "
        f"direction {steep}{towards}."
    )


def _obstacle(box: Obstacle) -> str:
    length, width, height = (2.0 * half * _CM for half in box.half_size)
    x, y, z = box.position
    bottom = z - box.half_size[2]
    if abs(bottom) < _ON_TABLE:
        where = "stands on the table"
    elif bottom > 0.0:
        where = f"is {bottom * _CM:.1f} cm up"
    else:
        where = f"begins {-bottom * _CM:.1f} cm below the table's top"
    return (
        f"A box of {length:.1f} by {width:.1f} by {height:.1f} cm, which the robot must not touch, "
        f"{where} at x {x:.3f}, y {y:.3f} m, turned by {math.degrees(box.yaw):.0f}°."
    )


def _change(change: SceneChange) -> str:
    parts = []
    if any(change.shift):
        x, y = (shift * _CM for shift in change.shift)
        parts.append(f"it is moved by {x:+.1f} cm in x and {y:+.1f} cm in y")
    if change.turn:
        parts.append(f"it is turned by {math.degrees(change.turn):+.0f}°")
    scales = {
        "the friction of contacts": change.contact_friction,
        "the dry friction of its joints": change.joint_friction,
        "the damping of its joints": change.damping,
        "its mass": change.mass,
    }
    parts += [f"{what} is scaled by {scale:.2f}" for what, scale in scales.items() if scale != 1.0]
    return f"The object is changed: {', '.join(parts) or 'by nothing'}."


def _heading(angle: float) -> str:
    degrees = math.degrees(math.remainder(angle, 2.0 * math.pi))
    if abs(degrees) < 0.5:
        return "straight ahead from the robot"
    return f"{abs(degrees):.0f}° to the {'left' if degrees > 0.0 else 'right'} of straight ahead"
