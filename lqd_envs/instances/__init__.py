"""Task instances: occasions on which a task is to be done, which nobody named beforehand."""

from lqd_envs.instances.approach_limit import ApproachLimit
from lqd_envs.instances.description import describe
from lqd_envs.instances.generator import KINDS, generate_instances
from lqd_envs.instances.held_part import HeldPart
from lqd_envs.instances.instance import Instance
from lqd_envs.instances.instance_error import InstanceError
from lqd_envs.instances.joint_band import JointBand
from lqd_envs.instances.moved_sector import MovedSector
from lqd_envs.instances.obstacle import Obstacle
from lqd_envs.instances.predicate import Predicate
from lqd_envs.instances.scene_change import SceneChange

__all__ = [
    "KINDS",
    "ApproachLimit",
    "HeldPart",
    "Instance",
    "InstanceError",
    "JointBand",
    "MovedSector",
    "Obstacle",
    "Predicate",
    "SceneChange",
    "describe",
    "generate_instances",
]
