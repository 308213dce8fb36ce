"""The robot at its table: what every scene shares."""

import mujoco

from lqd_envs.scenes.panda import ROBOT_BIT, load_panda

OBJECT_BIT = 2
"""Collision bit of a movable object, which the table supports."""
TABLE = "table"
CAMERA = "overview"
PHYSICS_STEP = 0.0025
"""Physics step in s; how it was chosen stands in docs/physics.md."""

MAX_PICTURE = (1920, 1440)
"""Largest width and height of a picture, in pixels."""

_TABLE_CENTER = (0.35, 0.0)
_TABLE_HALF_SIZE = (0.55, 0.6)
_TABLE_THICKNESS = 0.04
_TABLE_HEIGHT = 0.75


def new_workspace(name: str) -> mujoco.MjSpec:
    """Return a spec with the robot at its table, lights and a camera, ready for an object.

    World frame: the robot's base at the origin, x away from it, y to its left, z up; the table
    top is the plane z = 0.
    """
    spec = load_panda()
    spec.modelname = name
    _set_options(spec)
    _add_materials(spec)
    _add_table(spec)
    _add_lights_and_camera(spec)
    return spec


def _set_options(spec: mujoco.MjSpec) -> None:
    spec.option.timestep = PHYSICS_STEP
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    # Holding needs the elliptic cone: with the default pyramid a held mug creeps 20 times faster.
    spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    spec.option.impratio = 10.0
    spec.option.disableflags = int(mujoco.mjtDisableBit.mjDSBL_ISLAND) | int(
        mujoco.mjtDisableBit.mjDSBL_MULTICCD
    )


def _add_materials(spec: mujoco.MjSpec) -> None:
    spec.add_texture(
        name="sky",
        type=mujoco.mjtTexture.mjTEXTURE_SKYBOX,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_GRADIENT,
        rgb1=(0.86, 0.89, 0.93),
        rgb2=(0.55, 0.62, 0.70),
        width=256,
        height=256,
    )
    spec.add_texture(
        name="tiles",
        type=mujoco.mjtTexture.mjTEXTURE_2D,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_CHECKER,
        rgb1=(0.56, 0.58, 0.60),
        rgb2=(0.52, 0.54, 0.56),
        width=256,
        height=256,
    )
    floor = spec.add_material(name="floor", texrepeat=(6.0, 6.0), reflectance=0.05)
    floor.textures[int(mujoco.mjtTextureRole.mjTEXROLE_RGB)] = "tiles"
    spec.add_material(name="wood", rgba=(0.72, 0.57, 0.42, 1.0), specular=0.15, shininess=0.2)
    spec.add_material(name="steel", rgba=(0.32, 0.34, 0.37, 1.0), specular=0.5, shininess=0.5)


def _add_table(spec: mujoco.MjSpec) -> None:
    world = spec.worldbody
    # A plane, not a box: nothing can tunnel through it, and it is the cheapest shape to collide.
    world.add_geom(
        name=TABLE,
        type=mujoco.mjtGeom.mjGEOM_PLANE,
        pos=(*_TABLE_CENTER, 0.0),
        size=(*_TABLE_HALF_SIZE, 0.1),
        contype=0,
        conaffinity=ROBOT_BIT | OBJECT_BIT,
        # Of two surfaces the higher friction counts, so that what lies on the table decides.
        friction=(0.2, 0.005, 0.0001),
        group=3,
    )
    visual = {"contype": 0, "conaffinity": 0, "group": 1}
    world.add_geom(
        type=mujoco.mjtGeom.mjGEOM_BOX,
        pos=(*_TABLE_CENTER, -_TABLE_THICKNESS / 2 - 1e-4),
        size=(*_TABLE_HALF_SIZE, _TABLE_THICKNESS / 2),
        material="wood",
        **visual,
    )
    leg = (_TABLE_HEIGHT - _TABLE_THICKNESS) / 2
    for x in (-1.0, 1.0):
        for y in (-1.0, 1.0):
            world.add_geom(
                type=mujoco.mjtGeom.mjGEOM_BOX,
                pos=(
                    _TABLE_CENTER[0] + x * (_TABLE_HALF_SIZE[0] - 0.05),
                    _TABLE_CENTER[1] + y * (_TABLE_HALF_SIZE[1] - 0.05),
                    -_TABLE_THICKNESS - leg,
                ),
                size=(0.03, 0.03, leg),
                material="steel",
                **visual,
            )
    world.add_geom(
        type=mujoco.mjtGeom.mjGEOM_PLANE,
        pos=(0.0, 0.0, -_TABLE_HEIGHT),
        size=(3.0, 3.0, 0.1),
        material="floor",
        **visual,
    )


def _add_lights_and_camera(spec: mujoco.MjSpec) -> None:
    spec.worldbody.add_light(
        pos=(0.6, 1.0, 2.2),
        dir=(-0.1, -0.45, -1.0),
        diffuse=(0.5, 0.5, 0.5),
        specular=(0.2, 0.2, 0.2),
        castshadow=True,
    )
    spec.worldbody.add_light(
        pos=(1.8, -1.0, 1.8), dir=(-0.7, 0.5, -1.0), diffuse=(0.3, 0.3, 0.3), castshadow=False
    )
    spec.visual.headlight.ambient = (0.45, 0.45, 0.45)
    spec.visual.headlight.diffuse = (0.25, 0.25, 0.25)
    spec.visual.quality.shadowsize = 4096
    spec.visual.global_.offwidth = MAX_PICTURE[0]
    spec.visual.global_.offheight = MAX_PICTURE[1]
    spec.worldbody.add_camera(
        name=CAMERA,
        pos=(0.00, 0.96, 0.62),
        xyaxes=(-0.9088, -0.4173, 0.0000, 0.1514, -0.3298, 0.9318),
        fovy=45.0,
    )
    spec.stat.center = (0.4, 0.0, 0.2)
    spec.stat.extent = 1.2
