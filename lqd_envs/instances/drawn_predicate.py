"""Drawing predicates."""

import math
from collections.abc import Callable

import numpy as np

from lqd_envs.instances.held_part import HeldPart
from lqd_envs.instances.instance import Instance
from lqd_envs.instances.instance_error import InstanceError
from lqd_envs.instances.joint_band import JointBand
from lqd_envs.instances.moved_sector import MovedSector
from lqd_envs.instances.predicate import Predicate
from lqd_envs.instances.rounding import rounded
from lqd_envs.scenes.chest import DRAWER_RANGE
from lqd_envs.scenes.faucet import TAP_RANGE
from lqd_envs.tasks.drawer import DRAWER, OPEN_DISTANCE
from lqd_envs.tasks.faucet import FAUCET, OPEN_ANGLE
from lqd_envs.tasks.grasp import GRASP
from lqd_envs.tasks.push import PUSH, PUSH_DISTANCE
from lqd_envs.tasks.task import Task

_COLD_TAP_SHARE = 0.1
_COLD_TAP_LEEWAY = (0.01, 0.10)
_TAP_BAND = (0.15, 0.50)
_DRAWER_BAND = (0.015, 0.040)
_SECTOR_HALF_WIDTH = (math.radians(15.0), math.radians(45.0))
_SECTOR_NEAREST = (PUSH_DISTANCE, 0.10)
_SECTOR_DEPTH = (0.03, 0.10)
_HELD_FROM = (-0.01, 0.05)
_HELD_BAND = (0.03, 0.06)
_PARTS = ("handle", "rim", "body")


def draw_predicate(task: Task, *, rng: np.random.Generator) -> Instance:
    """Draw an instance that asks for one of the outcomes that a task's successes have.

    Faucet: the hot tap ends in a band 0.15 to 0.50 rad wide that lies between 0.314 rad and fully
    open; one in ten asks instead that the cold tap stays within 0.01 to 0.10 rad of closed.
    Drawer: it ends in a band 1.5 to 4 cm wide between 10 and 20 cm. Mug, grasped: it is held by its
    handle, rim or body, with the fingertips in a band of heights 3 to 6 cm wide that starts
    between 1 cm below its bottom and 5 cm above. Mug, pushed: it ends in a sector of any direction,
    30 to 90 degrees wide, that begins 5 to 10 cm from its start and is 3 to 10 cm deep.

    Args:
        task: One of the paper's tasks.
        rng: Source of randomness.

    Raises:
        InstanceError: There are no predicates for the task.
    """
    draws: dict[str, Callable[[np.random.Generator], Predicate]] = {
        FAUCET.id: _tap_band,
        DRAWER.id: _drawer_band,
        GRASP.id: _held_part,
        PUSH.id: _sector,
    }
    if task.id not in draws:
        raise InstanceError(
            f"Expected one of the paper's tasks to draw a predicate for, but got {task.id}; make "
            "Instances of it from predicates of your own."
        )
    return Instance(task=task.id, predicate=draws[task.id](rng))


def _tap_band(rng: np.random.Generator) -> JointBand:
    if rng.random() < _COLD_TAP_SHARE:
        return JointBand("cold_tap", 0.0, rounded(rng.uniform(*_COLD_TAP_LEEWAY)))
    low, high = _band(rng, within=(OPEN_ANGLE, TAP_RANGE), width=_TAP_BAND)
    return JointBand("hot_tap", low, high)


def _drawer_band(rng: np.random.Generator) -> JointBand:
    low, high = _band(rng, within=(OPEN_DISTANCE, DRAWER_RANGE), width=_DRAWER_BAND)
    return JointBand("drawer", low, high)


def _held_part(rng: np.random.Generator) -> HeldPart:
    part = _PARTS[rng.integers(len(_PARTS))]
    low = rng.uniform(*_HELD_FROM)
    return HeldPart(part, rounded(low), rounded(low + rng.uniform(*_HELD_BAND)))


def _sector(rng: np.random.Generator) -> MovedSector:
    direction = rng.uniform(-math.pi, math.pi)
    half_width = rng.uniform(*_SECTOR_HALF_WIDTH)
    nearest = rng.uniform(*_SECTOR_NEAREST)
    return MovedSector(
        direction=rounded(direction),
        half_width=rounded(half_width),
        nearest=rounded(nearest),
        farthest=rounded(nearest + rng.uniform(*_SECTOR_DEPTH)),
    )


def _band(
    rng: np.random.Generator, *, within: tuple[float, float], width: tuple[float, float]
) -> tuple[float, float]:
    drawn = rng.uniform(*width)
    low = rng.uniform(within[0], within[1] - drawn)
    return rounded(low), rounded(low + drawn)
