import itertools
import math

import mujoco
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from lqd_envs import get_task
from lqd_envs.kinematics import ArmKinematics
from lqd_envs.scene import load_scene
from lqd_envs.scenes.mug import MUG_HEIGHT, MUG_POINTS, MUG_RADIUS
from lqd_envs.scenes.panda import FINGER_OPEN, FINGER_SQUEEZE, GRIPPER_SITE, HOME

DROP = 0.002
"""Height, in m, from which the mug falls."""
DEEPEST_WALL = 0.004
FINGER = (0.015, 0.029)
"""Thickness and width of a finger, in m."""
SECOND = 50
"""Control steps in a second."""
AXIS_ALONG = Rotation.from_euler("y", 90, degrees=True)
"""Lays the mug's axis along x."""


@pytest.fixture(scope="module")
def scene():
    return load_scene(get_task("LQD/Push-v0"))


@pytest.fixture(scope="module")
def mug_geoms(scene):
    """Ids of what the robot touches of the mug, what is only looked at left out."""
    mug = scene.model.body("mug").id
    return [
        geom
        for geom in np.flatnonzero(scene.model.geom_bodyid == mug)
        if scene.model.geom_conaffinity[geom]
    ]


def standing(scene):
    data = mujoco.MjData(scene.model)
    data.qpos[:] = scene.start_qpos(HOME)
    data.ctrl[:] = [*HOME, FINGER_OPEN, FINGER_OPEN]
    mujoco.mj_forward(scene.model, data)
    return data


def corners_of(model, geom):
    """(n, 3) points in a geom's own frame, and a radius around them: together they hold it."""
    kind, (a, b, c) = int(model.geom_type[geom]), model.geom_size[geom]
    if kind == int(mujoco.mjtGeom.mjGEOM_BOX):
        return np.array(list(itertools.product((-a, a), (-b, b), (-c, c)))), 0.0
    if kind == int(mujoco.mjtGeom.mjGEOM_CAPSULE):
        return np.array([(0.0, 0.0, -b), (0.0, 0.0, b)]), a
    assert kind == int(mujoco.mjtGeom.mjGEOM_CYLINDER)
    turns = np.linspace(0.0, 2 * math.pi, 33)[:-1]
    return np.array([(a * math.cos(t), a * math.sin(t), z) for t in turns for z in (-b, b)]), 0.0


def lowest(model, data, geoms):
    """Height of the lowest point of some geoms, in m."""
    heights = []
    for geom in geoms:
        corners, radius = corners_of(model, geom)
        frame = data.geom_xmat[geom].reshape(3, 3)
        heights.append((corners @ frame.T + data.geom_xpos[geom])[:, 2].min() - radius)
    return min(heights)


def dropped(scene, geoms, rotation):
    """The mug at rest, some seconds after it fell in a given orientation."""
    data = standing(scene)
    joint = data.joint("mug")
    joint.qpos[2] = 0.2
    joint.qpos[3:] = rotation.as_quat(scalar_first=True)
    mujoco.mj_forward(scene.model, data)
    joint.qpos[2] += DROP - lowest(scene.model, data, geoms)
    mujoco.mj_step(scene.model, data, nstep=round(3.0 / scene.model.opt.timestep))
    mujoco.mj_forward(scene.model, data)
    return data


def table_contacts(scene, data):
    table = scene.model.geom("table").id
    return [contact for contact in data.contact if table in contact.geom]


def on_table(scene, data):
    return scene.sensors.columns(data.sensordata[None, None]).object_table_contact.item()


def test_mass_is_plausible(scene):
    assert 0.2 <= scene.model.body("mug").mass[0] <= 0.4


def hit_by_ray(scene, data, start, direction):
    """Name of the body that a ray meets first, and where; an empty name if it meets nothing."""
    geom = np.array([-1], dtype=np.int32)
    distance = mujoco.mj_ray(
        scene.model, data, np.array(start), np.array(direction), None, 1, -1, geom, None
    )
    body = scene.model.body(scene.model.geom_bodyid[geom[0]]).name if geom[0] >= 0 else ""
    return body, np.add(start, np.multiply(distance, direction))


def test_mug_is_hollow_and_has_a_bottom(scene):
    data = standing(scene)
    x, y, z = data.joint("mug").qpos[:3]

    body, place = hit_by_ray(scene, data, (x, y, z + 1.2 * MUG_HEIGHT), (0.0, 0.0, -1.0))

    assert body == "mug"
    assert 0.002 < place[2] < 0.15 * MUG_HEIGHT


def test_handle_has_a_hole_that_a_finger_fits_through(scene):
    data = standing(scene)
    outside = data.site("mug_handle").xpos
    axis = np.array([*data.joint("mug").qpos[:2], outside[2]])
    outwards = (outside - axis) / np.linalg.norm(outside - axis)
    sideways = np.cross(outwards, (0.0, 0.0, 1.0))

    assert hit_by_ray(scene, data, outside + 0.1 * outwards, -outwards)[0] == "mug"
    for away in MUG_RADIUS + 0.001, MUG_RADIUS + 0.001 + FINGER[0]:
        for up in -FINGER[1] / 2, FINGER[1] / 2:
            start = axis + away * outwards + (0.0, 0.0, up) - 0.2 * sideways
            assert hit_by_ray(scene, data, start, sideways)[0] != "mug"


def test_standing_mug_neither_creeps_nor_jitters(scene):
    data = standing(scene)
    start = np.array([data.site(name).xpos.copy() for name in MUG_POINTS])
    ways = []
    for _ in range(5 * SECOND):
        mujoco.mj_step(scene.model, data, nstep=scene.substeps)
        mujoco.mj_kinematics(scene.model, data)
        now = np.array([data.site(name).xpos for name in MUG_POINTS])
        ways.append(np.linalg.norm(now - start, axis=1).max())
    assert max(ways) < 1e-4


def test_standing_mug_rests_on_four_contacts(scene):
    data = standing(scene)
    for _ in range(SECOND):
        mujoco.mj_step(scene.model, data, nstep=scene.substeps)
        mujoco.mj_forward(scene.model, data)
        assert len(table_contacts(scene, data)) == len(data.contact) == 4


def assert_lies_on_the_table(scene, geoms, rotation):
    data = dropped(scene, geoms, rotation)

    assert np.abs(data.joint("mug").qvel).max() < 1e-3
    assert on_table(scene, data)
    assert lowest(scene.model, data, geoms) > -DEEPEST_WALL


@pytest.mark.parametrize("roll", range(0, 360, 15))
def test_mug_on_its_side_lies_on_the_table(scene, mug_geoms, roll):
    lying = AXIS_ALONG * Rotation.from_euler("z", roll, degrees=True)

    assert_lies_on_the_table(scene, mug_geoms, lying)


@pytest.mark.parametrize("yaw", range(0, 360, 60))
def test_mug_upside_down_stands_on_its_rim(scene, mug_geoms, yaw):
    rim_down = Rotation.from_euler("zx", (yaw, 180), degrees=True)

    assert_lies_on_the_table(scene, mug_geoms, rim_down)


@pytest.mark.parametrize("seed", range(20))
def test_mug_that_fell_anyhow_lies_on_the_table(scene, mug_geoms, seed):
    assert_lies_on_the_table(scene, mug_geoms, Rotation.random(rng=np.random.default_rng(seed)))


GRASPS = {
    "body": ((0.5, 0.0, 0.05), (0.0, 0.0, math.pi / 2)),
    "rim": ((0.4665, 0.0, 0.072), (0.0, 0.0, math.pi / 2)),
    "handle": ((0.5, 0.0605, 0.05), (0.0, 0.0, 0.0)),
}


@pytest.mark.parametrize("grasp", GRASPS)
def test_scripted_grasp_holds(grasp):
    scene = load_scene(get_task("LQD/Grasp-v0"))
    model, data = scene.model, mujoco.MjData(scene.model)
    position, angles = GRASPS[grasp]
    kinematics = ArmKinematics(threads=1)
    arm, reached = kinematics.reach(
        np.array([position]), Rotation.from_euler("xyz", np.array([angles]))
    )
    assert reached[0]
    data.qpos[:] = scene.start_qpos(arm[0])
    data.ctrl[:7], data.ctrl[7:] = arm[0], FINGER_OPEN
    mujoco.mj_forward(model, data)
    assert not scene.sensors.robot_touches(data.sensordata)

    for target in np.linspace(FINGER_OPEN, FINGER_SQUEEZE, 20):
        data.ctrl[7:] = target
        mujoco.mj_step(model, data, nstep=scene.substeps)
    lift = np.linspace(0.0, 0.1, 50)[None, :, None] * np.array([0.0, 0.0, 1.0])
    for configuration in kinematics.follow(arm, lift)[0]:
        data.ctrl[:7] = configuration
        mujoco.mj_step(model, data, nstep=scene.substeps)
    mujoco.mj_step(model, data, nstep=25 * scene.substeps)
    before = mug_in_gripper(model, data)
    mujoco.mj_step(model, data, nstep=100 * scene.substeps)
    after_two_seconds = mug_in_gripper(model, data)
    mujoco.mj_step(model, data, nstep=150 * scene.substeps)

    assert np.linalg.norm(after_two_seconds - before) < 1e-3
    end = scene.sensors.columns(data.sensordata[None, None])
    assert end.gripper_contacts[0, 0, 0]
    assert not end.object_table_contact[0, 0]
    assert end.object_position[0, 0, 2] > 0.08


def mug_in_gripper(model, data):
    """Return the position of the mug's centre of mass in the gripper's frame."""
    site = data.site(GRIPPER_SITE)
    return site.xmat.reshape(3, 3).T @ (data.xipos[model.body("mug").id] - site.xpos)
