"""The scene of an instance: the task's own, changed and with obstacles in it."""

import math
from dataclasses import dataclass

import mujoco

from lqd_envs.instances.obstacle import Obstacle
from lqd_envs.instances.scene_change import SceneChange
from lqd_envs.perception import Vector3
from lqd_envs.scenes.panda import ROBOT_BASE, ROBOT_BIT
from lqd_envs.scenes.sensors import OBSTACLES
from lqd_envs.scenes.workspace import OBJECT_BIT
from lqd_envs.tasks.task import SceneBuilder

_OBSTACLE_BIT = 4
_ARM_BIT = 8
_FRICTION = 0.5
_CONTACT_TIME = 0.01
_COLOR = (0.36, 0.52, 0.40, 1.0)


@dataclass(frozen=True)
class InstanceScene:
    """Builds the scene of an instance; compared by what it builds.

    Attributes:
        build_scene: Makes the task's own scene.
        base: Body of that scene whose frame is the object's base.
        center: The task's centre, m, world frame.
        obstacles: Boxes to add.
        change: What to change, or None.
    """

    build_scene: SceneBuilder
    base: str
    center: Vector3
    obstacles: tuple[Obstacle, ...]
    change: SceneChange | None

    def __call__(self) -> mujoco.MjSpec:
        """Return the scene, sensors aside."""
        spec = self.build_scene()
        root = _root_of(spec.body(self.base))
        if self.change is not None:
            _place(root, self.change, center=self.center)
        if self.obstacles:
            _add_obstacles(spec, self.obstacles)
            _make_solid(spec, root)
        if self.change is not None:
            # Last, so that the friction of obstacles is scaled with all others.
            _scale(spec, root, self.change)
        return spec


def _root_of(body: mujoco.MjsBody) -> mujoco.MjsBody:
    while body.parent.name != "world":
        body = body.parent
    return body


def _place(root: mujoco.MjsBody, change: SceneChange, *, center: Vector3) -> None:
    cos, sin = math.cos(change.turn), math.sin(change.turn)
    x, y = root.pos[0] - center[0], root.pos[1] - center[1]
    root.pos = (
        center[0] + cos * x - sin * y + change.shift[0],
        center[1] + sin * x + cos * y + change.shift[1],
        root.pos[2],
    )
    half_cos, half_sin = math.cos(change.turn / 2), math.sin(change.turn / 2)
    w, i, j, k = root.quat
    # The turn about the vertical, times what it was.
    root.quat = (
        half_cos * w - half_sin * k,
        half_cos * i - half_sin * j,
        half_cos * j + half_sin * i,
        half_cos * k + half_sin * w,
    )


def _scale(spec: mujoco.MjSpec, root: mujoco.MjsBody, change: SceneChange) -> None:
    # The higher friction of two surfaces counts, so only all of them together scale every contact.
    for geom in spec.geoms:
        geom.friction = change.contact_friction * geom.friction
    for body in (root, *root.find_all("body")):
        for joint in body.joints:
            joint.frictionloss *= change.joint_friction
            joint.damping = change.damping * joint.damping
        if body.explicitinertial:
            body.mass *= change.mass
            body.inertia = change.mass * body.inertia
        for geom in body.geoms:
            geom.density *= change.mass
            geom.mass *= change.mass


def _add_obstacles(spec: mujoco.MjSpec, obstacles: tuple[Obstacle, ...]) -> None:
    spec.add_material(name=OBSTACLES, rgba=_COLOR, specular=0.2, shininess=0.3)
    body = spec.worldbody.add_body(name=OBSTACLES)
    for obstacle in obstacles:
        body.add_geom(
            type=mujoco.mjtGeom.mjGEOM_BOX,
            pos=obstacle.position,
            quat=(math.cos(obstacle.yaw / 2), 0.0, 0.0, math.sin(obstacle.yaw / 2)),
            size=obstacle.half_size,
            material=OBSTACLES,
            contype=_OBSTACLE_BIT,
            conaffinity=ROBOT_BIT | OBJECT_BIT | _ARM_BIT,
            condim=4,
            friction=(_FRICTION, 0.005, 0.0001),
            solref=(_CONTACT_TIME, 1.0),
            group=2,
        )


def _make_solid(spec: mujoco.MjSpec, root: mujoco.MjsBody) -> None:
    """Let obstacles stop the object, and the arm's first links, which nothing else stops."""
    robot = spec.body(ROBOT_BASE)
    for body in (robot, *robot.find_all("body")):
        for geom in body.geoms:
            if geom.meshname.endswith("_col") and not geom.contype:
                geom.contype = _ARM_BIT
    for body in (root, *root.find_all("body")):
        for geom in body.geoms:
            if geom.conaffinity & ROBOT_BIT:
                geom.conaffinity |= _OBSTACLE_BIT
