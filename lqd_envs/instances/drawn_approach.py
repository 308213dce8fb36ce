"""Drawing limits on the approach."""

import math

import numpy as np

from lqd_envs.instances.approach_limit import ApproachLimit
from lqd_envs.instances.instance import Instance
from lqd_envs.instances.rounding import rounded
from lqd_envs.tasks.task import Task

_STEEPEST, _FLATTEST = math.radians(90.0), math.radians(10.0)
_TOWARDS_SIDE = math.radians(120.0)
_HALF_ANGLE = (math.radians(25.0), math.radians(50.0))


def draw_approach(task: Task, *, rng: np.random.Generator) -> Instance:
    """Draw an instance in which the fingers must point into a cone at the start.

    The cone's axis is uniform over the directions from 10 degrees below the horizontal to straight
    down, and at most 120 degrees to the side of straight ahead: the arm does not reach around an
    object to point back at its own base. Half of its opening is 25 to 50 degrees.

    Args:
        task: The task.
        rng: Source of randomness.
    """
    # Uniform over the sphere: uniform in height and in azimuth.
    down = rng.uniform(math.sin(_FLATTEST), math.sin(_STEEPEST))
    azimuth = rng.uniform(-_TOWARDS_SIDE, _TOWARDS_SIDE)
    across = math.sqrt(1.0 - down * down)
    direction = (across * math.cos(azimuth), across * math.sin(azimuth), -down)
    return Instance(
        task=task.id,
        approach=ApproachLimit(
            direction=(rounded(direction[0]), rounded(direction[1]), rounded(direction[2])),
            half_angle=rounded(rng.uniform(*_HALF_ANGLE)),
        ),
    )
