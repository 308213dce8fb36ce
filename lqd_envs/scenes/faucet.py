"""A faucet with a hot and a cold tap, fixed to the table."""

import math

import mujoco

from lqd_envs.scenes.parts import dry_joint, solid
from lqd_envs.scenes.workspace import new_workspace

FAUCET_POSITION = (0.5, 0.0, 0.0)
"""Where the faucet stands, in m, world frame."""
TAP_RANGE = 2.0 * math.pi / 3.0
"""Angle at which a tap is fully open, in rad."""
TAP_OFFSET = 0.051
"""Distance of a tap's axis from the faucet's middle, in m: the usual 4 inches between two taps."""
LEVER_LENGTH = 0.07
"""Distance of a lever's tip from its tap's axis, in m."""
LEVER_HEIGHT = 0.14
"""Height of the levers above the table, in m."""

_FRICTION_TORQUE = 0.1
_FRICTION = 0.8


def build_faucet_scene() -> mujoco.MjSpec:
    """Return the scene: robot, table and faucet.

    Seen from the robot, the hot tap is on the left (+y), the cold one on the right. A closed
    tap's lever points outwards; opening swings it towards the robot, about the vertical.
    """
    spec = new_workspace("faucet")
    spec.add_material(name="chrome", rgba=(0.80, 0.82, 0.85, 1.0), specular=0.9, shininess=0.8)
    spec.add_material(name="hot", rgba=(0.78, 0.18, 0.16, 1.0), specular=0.4, shininess=0.4)
    spec.add_material(name="cold", rgba=(0.16, 0.35, 0.72, 1.0), specular=0.4, shininess=0.4)
    base = spec.worldbody.add_body(name="base", pos=FAUCET_POSITION)
    _add_base(base)
    _add_tap(base, name="hot_tap", side=1.0, material="hot")
    _add_tap(base, name="cold_tap", side=-1.0, material="cold")
    return spec


def _add_base(base: mujoco.MjsBody) -> None:
    """Add a low bridge, a pillar under each tap, and the spout between them."""
    spout = LEVER_HEIGHT - 0.02
    capsules = [
        ((0.0, -TAP_OFFSET, 0.015), (0.0, TAP_OFFSET, 0.015), 0.014),
        ((0.0, 0.0, 0.01), (0.0, 0.0, spout), 0.014),
        ((0.0, 0.0, spout), (-0.08, 0.0, spout), 0.011),
    ]
    capsules += [
        ((0.0, y, 0.015), (0.0, y, LEVER_HEIGHT - 0.04), 0.012) for y in (TAP_OFFSET, -TAP_OFFSET)
    ]
    for start, end, radius in capsules:
        base.add_geom(
            type=mujoco.mjtGeom.mjGEOM_CAPSULE,
            fromto=(*start, *end),
            size=(radius, 0.0, 0.0),
            **solid("chrome", friction=_FRICTION),
        )
    base.add_geom(
        type=mujoco.mjtGeom.mjGEOM_CYLINDER,
        pos=(0.0, 0.0, 0.004),
        size=(0.03, 0.004, 0.0),
        contype=0,
        conaffinity=0,
        group=2,
        material="chrome",
    )


def _add_tap(base: mujoco.MjsBody, *, name: str, side: float, material: str) -> None:
    tap = base.add_body(name=name, pos=(0.0, side * TAP_OFFSET, 0.0))
    tap.add_joint(
        name=name,
        type=mujoco.mjtJoint.mjJNT_HINGE,
        axis=(0.0, 0.0, side),
        **dry_joint(TAP_RANGE, friction=_FRICTION_TORQUE),
        damping=0.01,
        armature=0.0005,
    )
    tap.add_geom(
        type=mujoco.mjtGeom.mjGEOM_CAPSULE,
        fromto=(0.0, 0.0, LEVER_HEIGHT - 0.03, 0.0, 0.0, LEVER_HEIGHT),
        size=(0.014, 0.0, 0.0),
        mass=0.05,
        **solid(material, friction=_FRICTION),
    )
    tap.add_geom(
        type=mujoco.mjtGeom.mjGEOM_CAPSULE,
        fromto=(0.0, 0.0, LEVER_HEIGHT, 0.0, side * (LEVER_LENGTH - 0.008), LEVER_HEIGHT),
        size=(0.008, 0.0, 0.0),
        mass=0.05,
        **solid(material, friction=_FRICTION),
    )
    tap.add_site(name=f"{name}_tip", pos=(0.0, side * LEVER_LENGTH, LEVER_HEIGHT), group=4)
