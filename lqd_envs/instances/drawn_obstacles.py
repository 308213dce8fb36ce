"""Drawing obstacles."""

import math

import numpy as np

from lqd_envs.instances.instance import Instance
from lqd_envs.instances.instance_error import InstanceError
from lqd_envs.instances.keep_out import KeepOut, keep_out_of
from lqd_envs.instances.obstacle import Obstacle
from lqd_envs.instances.rounding import rounded
from lqd_envs.tasks.task import Task

_MOST = 3
_MOST_TRIES = 10_000
_FLOATING_SHARE = 0.5
_STANDING_DISTANCE, _FLOATING_DISTANCE = 0.25, 0.15
_STANDING_HALF_SIDE = (0.01, 0.05)
_STANDING_HALF_HEIGHT = (0.04, 0.15)
_FLOATING_HALF_SIDE = (0.03, 0.10)
_FLOATING_HALF_HEIGHT = (0.005, 0.015)
_FLOATING_BOTTOM = (0.05, 0.30)


def draw_obstacles(task: Task, *, rng: np.random.Generator) -> Instance:
    """Draw an instance with one to three boxes around the object.

    Half of those that are drawn stand on the table: 2 to 10 cm by 2 to 10 cm and 8 to 30 cm high,
    their middle within 25 cm of the task's centre. The others are boards that float: 6 to 20 cm by
    6 to 20 cm and 1 to 3 cm thick, within 15 cm of it, their underside 5 to 30 cm above the table.
    All are turned about the vertical at random. A box that comes within 2 cm of the object,
    wherever its joints can move it, of the arm where an episode starts, or of another box is
    replaced by a new one, of either kind: around tall objects fewer boards are left than boxes.

    Args:
        task: The task.
        rng: Source of randomness.

    Raises:
        InstanceError: The object and the arm leave no room for a box.
    """
    keep_out = keep_out_of(task)
    obstacles: list[Obstacle] = []
    for _ in range(1 + int(rng.integers(_MOST))):
        obstacles.append(_draw_clear(task, keep_out, rng=rng))
        keep_out = keep_out.around(obstacles[-1])
    return Instance(task=task.id, obstacles=tuple(obstacles))


def _draw_clear(task: Task, keep_out: KeepOut, *, rng: np.random.Generator) -> Obstacle:
    for _ in range(_MOST_TRIES):
        obstacle = _draw(task, rng=rng)
        if keep_out.allows(obstacle):
            return obstacle
    raise InstanceError(
        f"Expected room for a box around the object of {task.id}, but each of {_MOST_TRIES:,} that "
        "were drawn comes too near to the object, the arm or another box; make Instances of it "
        "from obstacles of your own."
    )


def _draw(task: Task, *, rng: np.random.Generator) -> Obstacle:
    if rng.random() < _FLOATING_SHARE:
        farthest, side, height = _FLOATING_DISTANCE, _FLOATING_HALF_SIDE, _FLOATING_HALF_HEIGHT
        bottom = rng.uniform(*_FLOATING_BOTTOM)
    else:
        farthest, side, height = _STANDING_DISTANCE, _STANDING_HALF_SIDE, _STANDING_HALF_HEIGHT
        bottom = 0.0
    distance, heading = farthest * math.sqrt(rng.random()), rng.uniform(-math.pi, math.pi)
    half_size = (
        rounded(rng.uniform(*side)),
        rounded(rng.uniform(*side)),
        rounded(rng.uniform(*height)),
    )
    return Obstacle(
        position=(
            rounded(task.center[0] + distance * math.cos(heading)),
            rounded(task.center[1] + distance * math.sin(heading)),
            rounded(bottom + half_size[2]),
        ),
        half_size=half_size,
        yaw=rounded(rng.uniform(-math.pi, math.pi)),
    )
