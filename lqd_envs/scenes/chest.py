"""A small chest with one drawer, fixed to the table."""

import mujoco

from lqd_envs.scenes.parts import dry_joint, solid
from lqd_envs.scenes.workspace import new_workspace

FRONT_X = 0.55
"""Where the drawer's front is when it is closed, in m, world frame."""
FRONT_HEIGHT = 0.11
"""Height of the front's middle above the table, in m."""
DRAWER_RANGE = 0.20
"""How far the drawer slides out, in m."""
HANDLE_GAP = 0.045
"""Distance from the front to the handle's bar, in m."""

_DEPTH, _HALF_WIDTH, _HEIGHT = 0.26, 0.14, 0.18
_PANEL = 0.006
_FRONT_HALF = (0.12, 0.05)
_HANDLE_HALF_LENGTH, _HANDLE_RADIUS = 0.05, 0.006
_FRICTION_FORCE = 1.5
_FRICTION = 0.6


def build_chest_scene() -> mujoco.MjSpec:
    """Return the scene: robot, table and a chest whose drawer opens towards the robot.

    The drawer slides along -x, up to 0.20 m. Its handle is a bar along y, 4.5 cm before the front,
    on two posts.
    """
    spec = new_workspace("chest")
    spec.add_material(name="oak", rgba=(0.55, 0.38, 0.24, 1.0), specular=0.2, shininess=0.3)
    spec.add_material(name="front", rgba=(0.70, 0.52, 0.34, 1.0), specular=0.2, shininess=0.3)
    spec.add_material(name="brass", rgba=(0.80, 0.66, 0.32, 1.0), specular=0.8, shininess=0.7)
    body = spec.worldbody.add_body(name="body", pos=(FRONT_X + _DEPTH / 2, 0.0, 0.0))
    _add_body(body)
    _add_drawer(body)
    return spec


def _add_body(body: mujoco.MjsBody) -> None:
    half = _PANEL / 2
    top = FRONT_HEIGHT + _FRONT_HALF[1]
    side = (_HALF_WIDTH - _FRONT_HALF[0]) / 2
    panels = {
        "top": ((0.0, 0.0, (top + _HEIGHT) / 2), (_DEPTH / 2, _HALF_WIDTH, (_HEIGHT - top) / 2)),
        "left": (
            (0.0, _HALF_WIDTH - side, top / 2),
            (_DEPTH / 2, side, top / 2),
        ),
        "right": (
            (0.0, -_HALF_WIDTH + side, top / 2),
            (_DEPTH / 2, side, top / 2),
        ),
        "plinth": (
            (0.0, 0.0, (FRONT_HEIGHT - _FRONT_HALF[1]) / 2),
            (_DEPTH / 2, _FRONT_HALF[0], (FRONT_HEIGHT - _FRONT_HALF[1]) / 2),
        ),
        "back": (
            (_DEPTH / 2 - half, 0.0, FRONT_HEIGHT),
            (half, *_FRONT_HALF),
        ),
    }
    for position, size in panels.values():
        body.add_geom(
            pos=position,
            size=size,
            type=mujoco.mjtGeom.mjGEOM_BOX,
            **solid("oak", friction=_FRICTION),
        )


def _add_drawer(body: mujoco.MjsBody) -> None:
    drawer = body.add_body(name="drawer", pos=(-_DEPTH / 2, 0.0, FRONT_HEIGHT))
    drawer.add_joint(
        name="drawer",
        type=mujoco.mjtJoint.mjJNT_SLIDE,
        axis=(-1.0, 0.0, 0.0),
        **dry_joint(DRAWER_RANGE, friction=_FRICTION_FORCE),
        damping=1.0,
    )
    depth = _DEPTH - 0.02
    width, height = _FRONT_HALF[0] - 0.002, _FRONT_HALF[1] - 0.002
    half = _PANEL / 2
    boxes = [
        ((half, 0.0, 0.0), (half, width, height), 0.3),
        ((depth / 2, width - half, -0.01), (depth / 2, half, height - 0.01), 0.1),
        ((depth / 2, -width + half, -0.01), (depth / 2, half, height - 0.01), 0.1),
        ((depth / 2, 0.0, -height + half), (depth / 2, width, half), 0.15),
        ((depth - half, 0.0, -0.01), (half, width, height - 0.01), 0.1),
    ]
    for position, size, mass in boxes:
        drawer.add_geom(
            pos=position,
            size=size,
            mass=mass,
            type=mujoco.mjtGeom.mjGEOM_BOX,
            **solid("front", friction=_FRICTION),
        )
    ends = (-_HANDLE_HALF_LENGTH, _HANDLE_HALF_LENGTH)
    bars = [(-HANDLE_GAP, ends[0], -HANDLE_GAP, ends[1])]
    bars += [(0.0, y, -HANDLE_GAP, y) for y in ends]
    for x0, y0, x1, y1 in bars:
        drawer.add_geom(
            fromto=(x0, y0, 0.0, x1, y1, 0.0),
            size=(_HANDLE_RADIUS, 0.0, 0.0),
            mass=0.02,
            type=mujoco.mjtGeom.mjGEOM_CAPSULE,
            **solid("brass", friction=_FRICTION),
        )
    drawer.add_site(name="drawer_handle", pos=(-HANDLE_GAP, 0.0, 0.0), group=4)
