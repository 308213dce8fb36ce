"""Where no obstacle may be: around the object, wherever it moves, and around the arm at home."""

from dataclasses import dataclass
from functools import lru_cache

import mujoco
import numpy as np
from numpy.typing import NDArray

from lqd_envs.instances.obstacle import Obstacle
from lqd_envs.scene import Scene, load_scene
from lqd_envs.scenes.panda import HOME, ROBOT_BASE, ROBOT_BIT
from lqd_envs.tasks.task import Task

CLEARANCE = 0.02
"""Least distance of an obstacle from the boxes around object and arm, m."""

_POSITIONS = 13


@dataclass(frozen=True)
class KeepOut:
    """Boxes along the world's axes that no obstacle may reach into.

    Attributes:
        low: (n, 3) float64 lower corners, m, world frame.
        high: (n, 3) float64 upper corners.
    """

    low: NDArray[np.float64]
    high: NDArray[np.float64]

    def allows(self, obstacle: Obstacle) -> bool:
        """Return whether an obstacle stays clear of every box by `CLEARANCE`."""
        center, half = np.array(obstacle.position), np.array(obstacle.half_size)
        cos, sin = np.cos(obstacle.yaw), np.sin(obstacle.yaw)
        low, high = self.low - CLEARANCE, self.high + CLEARANCE
        offset, size = center - (low + high) / 2, (high - low) / 2
        apart = np.abs(offset[:, 2]) >= size[:, 2] + half[2]
        # Two rectangles seen from above are apart if they are along one of their sides.
        for axis, across in enumerate(_reach(obstacle)[:2]):
            apart |= np.abs(offset[:, axis]) >= size[:, axis] + across
        for axis, (x, y) in enumerate(((cos, sin), (-sin, cos))):
            reach = size[:, 0] * abs(x) + size[:, 1] * abs(y)
            apart |= np.abs(offset[:, 0] * x + offset[:, 1] * y) >= reach + half[axis]
        return bool(apart.all())

    def around(self, obstacle: Obstacle) -> "KeepOut":
        """Return these boxes and the one around an obstacle."""
        center, reach = np.array([obstacle.position]), _reach(obstacle)
        return KeepOut(
            low=np.concatenate([self.low, center - reach]),
            high=np.concatenate([self.high, center + reach]),
        )


@lru_cache(maxsize=8)
def keep_out_of(task: Task) -> KeepOut:
    """Return where no obstacle may be in a task's scene.

    These are the boxes around each solid of the object, at positions of each of its joints from
    closed to open, and around each solid of the arm where an episode starts.

    Args:
        task: The task.
    """
    scene = load_scene(task)
    data = mujoco.MjData(scene.model)
    corners = []
    for qpos in _states(scene):
        data.qpos[:] = qpos
        mujoco.mj_kinematics(scene.model, data)
        corners.append(_corners(scene, data))
    low, high = np.concatenate(corners, axis=1)
    return KeepOut(low=low, high=high)


def _reach(obstacle: Obstacle) -> NDArray[np.float64]:
    """Return (3,): how far an obstacle reaches from its centre along the world's axes, m."""
    x, y, z = obstacle.half_size
    cos, sin = abs(np.cos(obstacle.yaw)), abs(np.sin(obstacle.yaw))
    return np.array([cos * x + sin * y, sin * x + cos * y, z])


def _states(scene: Scene) -> list[NDArray[np.float64]]:
    start = scene.start_qpos(HOME)
    states = [start]
    for joint in scene.task.schema.joints:
        for position in np.linspace(0.0, joint.upper, _POSITIONS)[1:]:
            states.append(start.copy())
            states[-1][scene.model.joint(joint.name).qposadr[0]] = position
    return states


def _corners(scene: Scene, data: mujoco.MjData) -> NDArray[np.float64]:
    """Return (2, n, 3) lower and upper corners around the solids as they are in `data`."""
    model = scene.model
    root = model.body_rootid[model.geom_bodyid]
    of_object = root == model.body_rootid[model.body(scene.task.base).id]
    touchable = of_object & (model.geom_conaffinity & ROBOT_BIT > 0)
    of_robot = root == model.body(ROBOT_BASE).id
    geoms = np.flatnonzero(touchable | of_robot)
    frames = data.geom_xmat[geoms].reshape(-1, 3, 3)
    middle, half = model.geom_aabb[geoms, :3], model.geom_aabb[geoms, 3:]
    center = data.geom_xpos[geoms] + np.einsum("nij,nj->ni", frames, middle)
    reach = np.einsum("nij,nj->ni", np.abs(frames), half)
    return np.stack([center - reach, center + reach])
