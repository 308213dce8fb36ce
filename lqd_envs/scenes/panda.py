"""The Franka Panda arm with its parallel gripper."""

import importlib.util
from pathlib import Path

import mujoco

from lqd_envs.errors import LQDError

ARM_JOINTS = tuple(f"robot:panda0_joint{i}" for i in range(1, 8))
FINGER_JOINTS = ("robot:panda0_finger_joint1", "robot:panda0_finger_joint2")
ROBOT_BASE = "panda0_link0"
FLANGE = "panda0_link7"
GRIPPER = "gripper"
GRIPPER_SITE = "gripper_center"

FINGER_OPEN = 0.04
"""Travel of one finger when the gripper is fully open, in m."""
FINGER_SQUEEZE = -0.01
"""Lowest finger target, in m: below 0 the fingers press on what is between them, or their stops."""

HOME = (0.0, -0.3, 0.0, -2.2, 0.0, 0.33, 0.0)
"""Arm configuration above the table with the fingers pointing down, in rad."""

ROBOT_BIT = 1
"""Collision bit of the robot: an object or table that it can touch has it in `conaffinity`."""

# Finger drive: stiff and light enough to close from 40 mm in 0.3 s and to hold a thin wall with
# about 12 N. The asset's own values (armature 5, damping 100) are tuned for the kitchen and take
# over a second.
_FINGER_ARMATURE = 0.1
_FINGER_DAMPING = 20.0
_FINGER_GAIN = 1000.0
_COLLIDING_LINKS = ("link6", "link7", "hand")
_HAND_POSITION = (0.0, 0.0, 0.107)
_HAND_ROTATION = (0.92388, 0.0, 0.0, -0.382683)
_FINGER_POSITION = (0.0, 0.0, 0.0584)
_CENTER_POSITION = (0.0, 0.0, 0.143)
_HAND_MASS = 0.81909
_CONTACT_TIME = 0.01


def load_panda() -> mujoco.MjSpec:
    """Return a spec that holds the arm at the world's origin and nothing else.

    The meshes, masses and joint limits are those of gymnasium-robotics' Franka assets, which are
    read from where that package is installed, without importing it. Only the hand, the fingers
    (one box each) and the last two links collide, and none of them with another.

    Raises:
        LQDError: gymnasium-robotics is not installed.
    """
    folder = _asset_folder()
    spec = mujoco.MjSpec.from_string(
        f"""<mujoco>
              <include file="{folder / "assets.xml"}"/>
              <include file="{folder / "actuator.xml"}"/>
              <worldbody><include file="{folder / "chain.xml"}"/></worldbody>
            </mujoco>"""
    )
    for mesh in spec.meshes:
        file = Path(mesh.file)
        mesh.file = str(folder / "meshes" / file.parent.name / file.name)
    _keep_few_contacts(spec)
    _rebuild_gripper(spec)
    _configure_joints(spec)
    for body in spec.bodies[1:]:
        body.gravcomp = 1.0
    return spec


def _asset_folder() -> Path:
    module = importlib.util.find_spec("gymnasium_robotics")
    if module is None or module.origin is None:
        raise LQDError(
            "expected the package gymnasium-robotics, whose Franka meshes the scenes use, but it "
            "is not installed: run `pip install gymnasium-robotics`"
        )
    return Path(module.origin).parent / "envs/assets/kitchen_franka/franka_assets"


def _keep_few_contacts(spec: mujoco.MjSpec) -> None:
    for geom in list(spec.geoms):
        if geom.meshname.endswith("_col"):
            collides = geom.meshname.removesuffix("_col") in _COLLIDING_LINKS
            geom.contype = ROBOT_BIT if collides else 0
            geom.conaffinity = 0
            geom.group = 3
            geom.solref = (_CONTACT_TIME, 1.0)
        elif geom.meshname.endswith("_viz"):
            geom.group = 1


def _rebuild_gripper(spec: mujoco.MjSpec) -> None:
    """Give the hand and the fingers a body of their own, so that "the gripper" is one subtree."""
    flange = spec.body(FLANGE)
    for geom in list(flange.geoms):
        if geom.meshname.startswith("hand"):
            spec.delete(geom)
    for site in list(flange.sites):
        spec.delete(site)
    for finger in ("panda0_leftfinger", "panda0_rightfinger"):
        spec.delete(spec.body(finger))
    for actuator in list(spec.actuators):
        if "finger" in actuator.name:
            spec.delete(actuator)

    hand = flange.add_body(name=GRIPPER, pos=_HAND_POSITION, quat=_HAND_ROTATION)
    hand.add_geom(
        type=mujoco.mjtGeom.mjGEOM_MESH,
        meshname="hand_viz",
        contype=0,
        conaffinity=0,
        group=1,
        mass=0.0,
        rgba=(0.95, 0.95, 0.95, 1.0),
    )
    hand.add_geom(
        type=mujoco.mjtGeom.mjGEOM_MESH,
        meshname="hand_col",
        contype=ROBOT_BIT,
        conaffinity=0,
        group=3,
        mass=_HAND_MASS,
        solref=(_CONTACT_TIME, 1.0),
    )
    # Half a turn about x: the gripper's z axis points back from the fingers, so that its
    # orientation is zero when they point straight down.
    hand.add_site(name=GRIPPER_SITE, pos=_CENTER_POSITION, quat=(0.0, 1.0, 0.0, 0.0), group=4)
    for name, joint, side in zip(("left", "right"), FINGER_JOINTS, (1.0, -1.0), strict=True):
        _add_finger(spec, hand, name=name, joint=joint, side=side)


def _add_finger(
    spec: mujoco.MjSpec, hand: mujoco.MjsBody, *, name: str, joint: str, side: float
) -> None:
    finger = hand.add_body(
        name=f"{name}_finger",
        pos=_FINGER_POSITION,
        mass=0.0927059,
        ipos=(0.0, side * 0.0118731, 0.0434103),
        inertia=(6.57134e-05, 6.09611e-05, 1.09932e-05),
        explicitinertial=True,
    )
    finger.add_joint(
        name=joint,
        type=mujoco.mjtJoint.mjJNT_SLIDE,
        axis=(0.0, side, 0.0),
        range=(0.0, FINGER_OPEN),
        limited=True,
        armature=_FINGER_ARMATURE,
        damping=_FINGER_DAMPING,
    )
    finger.add_geom(
        type=mujoco.mjtGeom.mjGEOM_MESH,
        meshname="finger_viz",
        quat=(1.0, 0.0, 0.0, 0.0) if side > 0 else (0.0, 0.0, 0.0, 1.0),
        contype=0,
        conaffinity=0,
        group=1,
        mass=0.0,
        rgba=(0.35, 0.36, 0.38, 1.0),
    )
    finger.add_geom(
        name=f"{name}_pad",
        type=mujoco.mjtGeom.mjGEOM_BOX,
        pos=(0.0, side * 0.0075, 0.049),
        size=(0.0145, 0.0075, 0.045),
        contype=ROBOT_BIT,
        conaffinity=0,
        condim=4,
        friction=(0.5, 0.005, 0.0001),
        solref=(_CONTACT_TIME, 1.0),
        group=3,
        mass=0.0,
    )
    spec.add_actuator(
        name=f"{name}_finger",
        target=joint,
        trntype=mujoco.mjtTrn.mjTRN_JOINT,
        gaintype=mujoco.mjtGain.mjGAIN_FIXED,
        biastype=mujoco.mjtBias.mjBIAS_AFFINE,
        gainprm=[_FINGER_GAIN, *[0.0] * 9],
        biasprm=[0.0, -_FINGER_GAIN, *[0.0] * 8],
        ctrlrange=(FINGER_SQUEEZE, FINGER_OPEN),
        ctrllimited=True,
        forcerange=(-70.0, 70.0),
        forcelimited=True,
    )


def _configure_joints(spec: mujoco.MjSpec) -> None:
    for actuator in spec.actuators:
        if actuator.target in ARM_JOINTS:
            joint = spec.joint(actuator.target)
            actuator.ctrlrange = joint.range
