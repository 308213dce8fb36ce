import mujoco
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from lqd_envs import Verdict
from lqd_envs.kinematics import ArmKinematics
from lqd_envs.motion import start_poses
from lqd_envs.scenes.panda import ARM_JOINTS, GRIPPER_SITE
from lqd_envs.scenes.sensors import SensorReader

GRIPPER_BODIES = {"gripper", "left_finger", "right_finger"}
STATES = 60


def perceive(scene, data):
    """The one info that the sensors give."""
    return scene.sensors.columns(data.sensordata[None, None]).infos(0)[0]


def assert_flags_agree(scene, data, contacts):
    info = perceive(scene, data)
    touched = {contact.body for contact in contacts if contact.robot in GRIPPER_BODIES}
    assert info["gripper_contacts"] == {
        link: link in touched for link in ("base", "hot_tap", "cold_tap")
    }
    assert info["robot_table_contact"] == any(contact.geom == "table" for contact in contacts)
    assert scene.sensors.robot_touches(data.sensordata) == bool(contacts)
    deepest = max([-contact.distance for contact in contacts], default=0.0)
    assert scene.sensors.depth(data.sensordata) == pytest.approx(max(deepest, 0.0), abs=1e-12)


def test_flags_agree_with_the_contacts_of_overlapping_starts(
    scene, trajectories, started, robot_contacts
):
    rows = np.flatnonzero(trajectories.verdicts == Verdict.OVERLAPPING)[:STATES]
    touched = set()

    for i in rows:
        data = started(trajectories.plan.starts[i])
        contacts = robot_contacts(data)
        assert_flags_agree(scene, data, contacts)
        touched |= {contact.geom or contact.body for contact in contacts}

    assert touched == {"table", "base", "hot_tap", "cold_tap"}


def test_flags_agree_with_the_contacts_of_random_arms(scene, started, robot_contacts):
    limits = [scene.model.joint(name).range for name in ARM_JOINTS]
    arms = np.random.default_rng(8).uniform(*np.transpose(limits), (400, 7))
    on_table = set()

    for arm in arms:
        data = started(arm)
        contacts = robot_contacts(data)
        assert_flags_agree(scene, data, contacts)
        on_table |= {contact.robot for contact in contacts if contact.geom == "table"}

    assert on_table == {"panda0_link6", "panda0_link7", *GRIPPER_BODIES}


def test_flags_agree_with_the_contacts_while_it_moves(scene, turning, started, robot_contacts):
    data = started(turning.plan.starts[0])
    touched = set()

    for control in scene.action_map.controls(turning.plan.actions[0]):
        data.ctrl[:] = control
        mujoco.mj_step(scene.model, data, nstep=scene.substeps)
        mujoco.mj_forward(scene.model, data)
        contacts = robot_contacts(data)
        assert_flags_agree(scene, data, contacts)
        touched |= {contact.body for contact in contacts}

    assert "hot_tap" in touched


def test_nothing_is_touched_where_nothing_is(scene, started):
    data = started((0.0, -0.3, 0.0, -2.2, 0.0, 0.33, 0.0))

    info = perceive(scene, data)

    assert not any(info["gripper_contacts"].values())
    assert info["robot_table_contact"] is False
    assert scene.sensors.depth(data.sensordata) == 0.0


@pytest.fixture(scope="module")
def pointing(started):
    """A function that puts the gripper in the middle of the reach with a given orientation."""

    def start(rpy):
        rotation = Rotation.from_euler("xyz", [rpy])
        arm, reached = ArmKinematics().reach(np.array([[0.45, 0.0, 0.3]]), rotation)
        assert reached.all()
        return started(arm[0])

    return start


def test_straight_down_and_closing_along_y_reads_zero(scene, pointing):
    data = pointing((0.0, 0.0, 0.0))
    tip = data.site(GRIPPER_SITE).xpos
    apart = data.body("left_finger").xpos - data.body("right_finger").xpos

    direction = (tip - data.body("gripper").xpos) / np.linalg.norm(tip - data.body("gripper").xpos)
    assert direction == pytest.approx((0.0, 0.0, -1.0), abs=1e-2)
    assert np.abs(apart) == pytest.approx((0.0, 0.08, 0.0), abs=1e-3)
    assert perceive(scene, data)["gripper_orientation"] == pytest.approx((0.0, 0.0, 0.0), abs=1e-2)


@pytest.mark.parametrize(
    "rpy", [(0.3, 0, 0), (0, -0.4, 0), (0, 0, 1.0), (0.3, -0.4, 1.0), (-0.5, 0.6, -1.2)]
)
def test_known_rotations_read_back(scene, pointing, rpy):
    data = pointing(rpy)
    tip, palm = data.site(GRIPPER_SITE).xpos, data.body("gripper").xpos

    assert perceive(scene, data)["gripper_orientation"] == pytest.approx(rpy, abs=2e-2)
    # Turned about x, then y, then z of the world.
    x, y, z = (Rotation.from_rotvec(np.eye(3)[k] * rpy[k]) for k in range(3))
    direction = (z * y * x).apply((0.0, 0.0, -1.0))
    assert (tip - palm) / np.linalg.norm(tip - palm) == pytest.approx(direction, abs=1e-2)


def test_orientation_is_that_of_the_frame(scene, trajectories, started):
    for start in trajectories.plan.starts[trajectories.valid][:20]:
        data = started(start)
        frame = Rotation.from_matrix(data.site(GRIPPER_SITE).xmat.reshape(3, 3))

        read = Rotation.from_euler("xyz", perceive(scene, data)["gripper_orientation"])
        quaternion = scene.sensors.quaternion(data.sensordata, "gripper_orientation")

        assert (read * frame.inv()).magnitude() < 1e-7
        assert quaternion[0] >= 0.0
        expected = Rotation.from_quat(quaternion, scalar_first=True)
        assert (expected * frame.inv()).magnitude() < 1e-7


def test_starts_read_back_as_their_solutions(faucet, trajectories):
    positions, rotations = start_poses(faucet, trajectories.solutions)
    columns = trajectories.columns

    for i in np.flatnonzero(trajectories.simulated):
        read = Rotation.from_euler("xyz", columns.gripper_orientation[i, 0])
        assert np.linalg.norm(columns.gripper_position[i, 0] - positions[i]) < 1e-3
        assert (read * rotations[i].inv()).magnitude() < 1e-2


def test_gripper_position_is_between_the_fingertips(scene, started, trajectories):
    data = started(trajectories.plan.starts[trajectories.valid][0])

    tips = [
        # The pads are boxes: their far ends are half their length away along z.
        data.geom(pad).xpos + data.geom(pad).xmat.reshape(3, 3) @ (0.0, 0.0, 0.045)
        for pad in ("left_pad", "right_pad")
    ]

    position = perceive(scene, data)["gripper_position"]
    assert np.linalg.norm(np.mean(tips, axis=0) - position) < 0.015


def test_speed_is_that_of_the_tip(scene, started):
    data = started((0.0, -0.3, 0.0, -2.2, 0.0, 0.33, 0.0))
    data.joint("hot_tap").qvel[0] = -3.0
    data.joint("cold_tap").qvel[0] = 2.0
    mujoco.mj_forward(scene.model, data)

    assert scene.sensors.speed(data.sensordata) == pytest.approx(3.0 * 0.07)


def test_taps_are_read_by_their_names(scene, started):
    data = started((0.0, -0.3, 0.0, -2.2, 0.0, 0.33, 0.0))
    data.joint("hot_tap").qpos[0] = 0.5
    data.joint("cold_tap").qpos[0] = 1.25
    mujoco.mj_forward(scene.model, data)

    assert perceive(scene, data)["joint_positions"] == {"hot_tap": 0.5, "cold_tap": 1.25}


def test_reader_knows_every_sensor_of_the_model(faucet, scene):
    reader = SensorReader.of(scene.model, schema=faucet.schema)
    covered = sorted(i for part in reader.slices.values() for i in range(part.start, part.stop))

    assert covered == list(range(scene.model.nsensordata))
