import mujoco
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from lqd_envs import get_task
from lqd_envs.kinematics import ArmKinematics
from lqd_envs.scene import load_scene
from lqd_envs.scenes.chest import DRAWER_RANGE, FRONT_HEIGHT, FRONT_X, HANDLE_GAP
from lqd_envs.scenes.panda import FINGER_OPEN, FINGER_SQUEEZE, HOME

SECOND = 50
"""Control steps in a second."""
IN_THE_GAP = (FRONT_X - HANDLE_GAP / 2, 0.0, FRONT_HEIGHT - 0.005)
"""Where the closed fingers hang behind the handle's bar, in m."""


@pytest.fixture(scope="module")
def scene():
    return load_scene(get_task("LQD/Drawer-v0"))


def started(scene, *, arm=HOME, fingers=FINGER_OPEN, opening=0.0):
    data = mujoco.MjData(scene.model)
    data.qpos[:] = scene.start_qpos(arm)
    data.qpos[scene.finger_qpos] = fingers
    data.joint("drawer").qpos[0] = opening
    target = FINGER_OPEN if fingers else FINGER_SQUEEZE
    data.ctrl[:] = [*arm, target, target]
    mujoco.mj_forward(scene.model, data)
    return data


def pull(scene, data, *, force, seconds=1.0):
    """Simulate with a force at the middle of the handle, in N, towards the robot."""
    drawer = scene.model.body("drawer").id
    for _ in range(round(seconds / scene.model.opt.timestep)):
        data.qfrc_applied[:] = 0.0
        handle = data.site("drawer_handle").xpos
        mujoco.mj_applyFT(
            scene.model,
            data,
            np.array([-force, 0.0, 0.0]),
            np.zeros(3),
            handle,
            drawer,
            data.qfrc_applied,
        )
        mujoco.mj_step(scene.model, data)


def info_of(scene, data):
    return scene.sensors.columns(data.sensordata[None, None]).infos(0)[0]


@pytest.fixture(scope="module")
def hooked():
    """An arm configuration with the fingers pointing down into the handle's gap."""
    arm, reached = ArmKinematics().reach(
        np.array([IN_THE_GAP]), Rotation.from_euler("xyz", [(0.0, 0.0, 0.0)])
    )
    assert reached.all()
    return arm


def test_range_of_the_drawer(scene):
    joint = scene.model.joint("drawer")

    assert joint.range.tolist() == [0.0, DRAWER_RANGE] == [0.0, 0.20]
    assert bool(joint.limited[0])
    assert int(joint.type[0]) == int(mujoco.mjtJoint.mjJNT_SLIDE)


def test_drawer_slides_out_towards_the_robot(scene):
    closed, open_ = (started(scene, opening=out).site("drawer_handle").xpos for out in (0.0, 0.1))

    assert closed == pytest.approx((FRONT_X - HANDLE_GAP, 0.0, FRONT_HEIGHT))
    assert open_ - closed == pytest.approx((-0.1, 0.0, 0.0))


def test_centre_of_the_task_is_the_middle_of_the_front(scene):
    assert scene.task.center == (FRONT_X, 0.0, FRONT_HEIGHT)


def test_start_is_closed_and_touches_nothing(scene):
    data = started(scene)

    assert data.joint("drawer").qpos[0] == 0.0
    assert data.ncon == 0


def test_closed_drawer_stays_put(scene):
    data = started(scene)
    places = []
    for _ in range(SECOND):
        mujoco.mj_step(scene.model, data, nstep=scene.substeps)
        places.append(data.joint("drawer").qpos[0])

    assert np.abs(places).max() < 1e-6


@pytest.mark.parametrize("opening", [0.03, 0.10, 0.19])
def test_friction_holds_an_open_drawer(scene, opening):
    data = started(scene, opening=opening)

    mujoco.mj_step(scene.model, data, nstep=round(1.0 / scene.model.opt.timestep))

    assert data.joint("drawer").qpos[0] == pytest.approx(opening, abs=1e-5)


@pytest.mark.parametrize(("force", "opens"), [(1.0, False), (5.0, True)])
def test_drawer_yields_to_5_n_and_not_to_1_n(scene, force, opens):
    data = started(scene)

    pull(scene, data, force=force)

    opening = data.joint("drawer").qpos[0]
    # MuJoCo's friction yields a little under any force: the drawer creeps by a millimetre.
    assert opening > 0.15 if opens else abs(opening) < 1e-4


@pytest.mark.parametrize(("force", "end"), [(20.0, DRAWER_RANGE), (-20.0, 0.0)])
def test_stops_of_the_drawer_are_hard(scene, force, end):
    data = started(scene, opening=0.1)

    pull(scene, data, force=force)

    assert data.joint("drawer").qpos[0] == pytest.approx(end, abs=2e-3)


def test_moving_drawer_comes_to_rest_within_its_range(scene):
    data = started(scene)
    data.joint("drawer").qvel[0] = 1.5
    openings = []
    for _ in range(2 * SECOND):
        mujoco.mj_step(scene.model, data, nstep=scene.substeps)
        openings.append(data.joint("drawer").qpos[0])

    assert -2e-3 < min(openings) < max(openings) < DRAWER_RANGE + 5e-3
    assert abs(data.joint("drawer").qvel[0]) < 1e-4


def test_closed_gripper_fits_into_the_gap_behind_the_handle(scene, hooked):
    data = started(scene, arm=hooked[0], fingers=0.0)

    assert not scene.sensors.robot_touches(data.sensordata)
    # The fingertips are below the bar, which is between them and the robot.
    pads = [data.geom(name) for name in ("left_pad", "right_pad")]
    lowest = min(float(pad.xpos[2]) - 0.045 for pad in pads)
    assert lowest < data.site("drawer_handle").xpos[2] - 0.006
    assert all(pad.xpos[0] > data.site("drawer_handle").xpos[0] for pad in pads)


def test_closed_gripper_hooks_the_handle_and_opens_the_drawer(scene, hooked):
    data = started(scene, arm=hooked[0], fingers=0.0)
    ways = np.linspace(0.0, 0.16, SECOND)[None, :, None] * np.array([-1.0, 0.0, 0.0])
    (line,) = ArmKinematics().follow(hooked, ways)
    touched = []
    for arm in line:
        data.ctrl[:7] = arm
        mujoco.mj_step(scene.model, data, nstep=scene.substeps)
        mujoco.mj_forward(scene.model, data)
        touched.append(info_of(scene, data)["gripper_contacts"])

    assert any(contacts["drawer"] for contacts in touched)
    assert not any(contacts["body"] for contacts in touched)
    assert data.joint("drawer").qpos[0] > 0.10
