"""A mug with a handle, free on the table."""

import math

import mujoco

from lqd_envs.scenes.parts import solid
from lqd_envs.scenes.workspace import OBJECT_BIT, new_workspace

MUG_POSITION = (0.5, 0.0)
"""Where the mug stands, in m, world frame."""
MUG_RADIUS = 0.036
"""Outer radius in m."""
MUG_HEIGHT = 0.08
"""Height in m."""
WALL = 0.005
"""Thickness of the wall in m."""
HANDLE_REACH = 0.030
"""Distance from the wall to the far side's middle of the handle, in m."""

_SIDES = 8
_SEGMENTS = 48
_BOTTOM = 0.006
_BUMPER = 0.005
_HANDLE_RADIUS = 0.005
_HANDLE_HEIGHTS = (0.016, 0.064)
_WALL_MASS, _BOTTOM_MASS, _HANDLE_MASS = 0.32, 0.06, 0.005
_REST_TIME = 0.01
_FRICTION, _TABLE_FRICTION = 0.5, 0.2


def build_mug_scene() -> mujoco.MjSpec:
    """Return the scene: robot, table and a hollow mug of about 0.4 kg.

    Its handle points to the robot's left (+y). The walls, the bottom and the handle are what the
    robot touches; the table carries the mug on four small feet, and, when it has toppled, on two
    rings of bumpers and two more on the handle, so that it lies on the table in every pose.
    """
    spec = new_workspace("mug")
    spec.add_material(name="china", rgba=(0.93, 0.92, 0.88, 1.0), specular=0.5, shininess=0.6)
    spec.add_material(name="glaze", rgba=(0.20, 0.42, 0.55, 1.0), specular=0.6, shininess=0.6)
    mug = spec.worldbody.add_body(name="mug", pos=(*MUG_POSITION, 0.0))
    mug.add_freejoint(name="mug")
    _add_walls(mug)
    _add_shell(spec, mug)
    _add_handle(mug)
    _add_bumpers(mug)
    for name, position in _far_points().items():
        mug.add_site(name=name, pos=position, group=4)
    return spec


MUG_POINTS = ("mug_handle", "mug_rim_front", "mug_rim_back", "mug_bottom")
"""Sites at the mug's extremes, whose speed is watched."""


def _far_points() -> dict[str, tuple[float, float, float]]:
    middle = sum(_HANDLE_HEIGHTS) / 2
    points = (
        (0.0, MUG_RADIUS + HANDLE_REACH, middle),
        (-MUG_RADIUS, 0.0, MUG_HEIGHT),
        (MUG_RADIUS, 0.0, MUG_HEIGHT),
        (0.0, -MUG_RADIUS, 0.0),
    )
    return dict(zip(MUG_POINTS, points, strict=True))


def _add_walls(mug: mujoco.MjsBody) -> None:
    middle = MUG_RADIUS - WALL / 2
    half_width = MUG_RADIUS * math.tan(math.pi / _SIDES)
    for i in range(_SIDES):
        angle = 2.0 * math.pi * i / _SIDES
        mug.add_geom(
            type=mujoco.mjtGeom.mjGEOM_BOX,
            pos=(middle * math.cos(angle), middle * math.sin(angle), MUG_HEIGHT / 2),
            quat=(math.cos(angle / 2), 0.0, 0.0, math.sin(angle / 2)),
            size=(WALL / 2, half_width, MUG_HEIGHT / 2),
            mass=_WALL_MASS / _SIDES,
            **solid("china", friction=_FRICTION) | {"group": 3},
        )
    mug.add_geom(
        type=mujoco.mjtGeom.mjGEOM_CYLINDER,
        pos=(0.0, 0.0, _BOTTOM / 2),
        size=(MUG_RADIUS - WALL, _BOTTOM / 2, 0.0),
        mass=_BOTTOM_MASS,
        **solid("glaze", friction=_FRICTION),
    )


def _add_shell(spec: mujoco.MjSpec, mug: mujoco.MjsBody) -> None:
    """Add the round wall that is seen, in place of the eight flat ones that are touched."""
    outline = ((MUG_RADIUS, 0.0), (MUG_RADIUS, MUG_HEIGHT), (MUG_RADIUS - WALL, MUG_HEIGHT),
               (MUG_RADIUS - WALL, 0.0))  # fmt: skip
    vertices, faces = [], []
    n = len(outline)
    for i in range(_SEGMENTS):
        angle = 2.0 * math.pi * i / _SEGMENTS
        vertices += [(r * math.cos(angle), r * math.sin(angle), z) for r, z in outline]
        for j in range(n):
            here, above = i * n + j, i * n + (j + 1) % n
            beside = (i + 1) % _SEGMENTS * n
            faces += [(here, beside + j, above), (above, beside + j, beside + (j + 1) % n)]
    spec.add_mesh(
        name="mug_shell",
        uservert=[number for vertex in vertices for number in vertex],
        userface=[index for face in faces for index in face],
        smoothnormal=False,
    )
    mug.add_geom(
        type=mujoco.mjtGeom.mjGEOM_MESH,
        meshname="mug_shell",
        material="china",
        contype=0,
        conaffinity=0,
        mass=0.0,
        group=2,
    )


def _add_handle(mug: mujoco.MjsBody) -> None:
    low, high = _HANDLE_HEIGHTS
    near, far = MUG_RADIUS - WALL / 2, MUG_RADIUS + HANDLE_REACH - _HANDLE_RADIUS
    for start, end in (
        ((0.0, near, low), (0.0, far, low)),
        ((0.0, far, low), (0.0, far, high)),
        ((0.0, far, high), (0.0, near, high)),
    ):
        mug.add_geom(
            type=mujoco.mjtGeom.mjGEOM_CAPSULE,
            fromto=(*start, *end),
            size=(_HANDLE_RADIUS, 0.0, 0.0),
            mass=_HANDLE_MASS,
            **solid("glaze", friction=_FRICTION),
        )


def _add_bumpers(mug: mujoco.MjsBody) -> None:
    foot_radius = MUG_RADIUS - 0.010
    # At the edges between the flat walls, which stand out furthest when the mug lies.
    ring_radius = MUG_RADIUS / math.cos(math.pi / _SIDES) - _BUMPER
    feet = [(foot_radius, (i + 0.5) / 4, _BUMPER) for i in range(4)]
    # Above the feet's level, so that a standing mug rests on four contacts alone.
    low_ring = [(ring_radius, (i + 0.5) / _SIDES, _BUMPER + 0.002) for i in range(_SIDES)]
    rim = [(ring_radius, (i + 0.5) / _SIDES, MUG_HEIGHT - _BUMPER) for i in range(_SIDES)]
    positions = [
        (radius * math.cos(2 * math.pi * turn), radius * math.sin(2 * math.pi * turn), height)
        for radius, turn, height in (*feet, *low_ring, *rim)
    ]
    far = MUG_RADIUS + HANDLE_REACH - _BUMPER
    positions += [(0.0, far, height) for height in _HANDLE_HEIGHTS]
    for position in positions:
        mug.add_geom(
            type=mujoco.mjtGeom.mjGEOM_SPHERE,
            pos=position,
            size=(_BUMPER, 0.0, 0.0),
            contype=OBJECT_BIT,
            conaffinity=0,
            condim=4,
            friction=(_TABLE_FRICTION, 0.005, 0.0001),
            solref=(_REST_TIME, 1.0),
            mass=0.0,
            group=3,
        )
