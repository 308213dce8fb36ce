"""Drawing changes of the object."""

import math

import numpy as np

from lqd_envs.instances.instance import Instance
from lqd_envs.instances.rounding import rounded
from lqd_envs.instances.scene_change import SceneChange
from lqd_envs.tasks.task import Task

_FARTHEST = 0.03
_LARGEST_TURN = math.radians(20.0)
_LARGEST_SCALE = 2.0


def draw_change(task: Task, *, rng: np.random.Generator) -> Instance:
    """Draw an instance with a changed object.

    It is moved by up to 3 cm in any direction (uniform over the disc) and turned by up to 20
    degrees about the vertical through the task's centre. Contact friction and the object's mass
    are scaled by 1/2 to 2 (log-uniform), and so are the dry friction and the damping of its joints
    where it has any. Nothing of the arm is changed.

    Args:
        task: The task.
        rng: Source of randomness.
    """
    distance = _FARTHEST * math.sqrt(rng.random())
    heading = rng.uniform(-math.pi, math.pi)
    turn = rng.uniform(-_LARGEST_TURN, _LARGEST_TURN)
    contact_friction, mass, joint_friction, damping = (
        rounded(_LARGEST_SCALE ** rng.uniform(-1.0, 1.0)) for _ in range(4)
    )
    has_joints = bool(task.schema.joints)
    return Instance(
        task=task.id,
        change=SceneChange(
            shift=(rounded(distance * math.cos(heading)), rounded(distance * math.sin(heading))),
            turn=rounded(turn),
            contact_friction=contact_friction,
            joint_friction=joint_friction if has_joints else 1.0,
            damping=damping if has_joints else 1.0,
            mass=mass,
        ),
    )
