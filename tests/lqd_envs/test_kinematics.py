import mujoco
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from lqd_envs import LQDError
from lqd_envs.kinematics import ArmKinematics
from lqd_envs.motion import start_poses
from lqd_envs.scenes.panda import ARM_JOINTS, GRIPPER_SITE, HOME, load_panda

MIDDLE = np.array([0.45, 0.0, 0.25])


@pytest.fixture(scope="module")
def poses(faucet, solutions):
    return start_poses(faucet, solutions)


@pytest.fixture(scope="module")
def reached(poses):
    return ArmKinematics().reach(*poses)


@pytest.fixture(scope="module")
def limits(scene):
    return np.array([scene.model.joint(name).range for name in ARM_JOINTS]).T


@pytest.fixture(scope="module")
def gripper(started):
    """A function from an arm configuration to the gripper's pose, by plain `mj_forward`."""

    def pose(arm):
        site = started(arm).site(GRIPPER_SITE)
        return site.xpos.copy(), Rotation.from_matrix(site.xmat.reshape(3, 3))

    return pose


@pytest.fixture(scope="module")
def middle():
    """(1, 7): fingers straight down in the middle of the reach."""
    configurations, reached = ArmKinematics().reach(MIDDLE[None], Rotation.identity(1))
    assert reached.all()
    return configurations


def test_reached_poses_are_within_tolerance(poses, reached, gripper):
    positions, rotations = poses
    configurations, found = reached
    assert 0.5 < found.mean() < 1.0

    for i in np.flatnonzero(found):
        position, rotation = gripper(configurations[i])
        assert np.linalg.norm(position - positions[i]) < 1e-3
        assert (rotation * rotations[i].inv()).magnitude() < 1e-2


def test_unreached_poses_are_not_there(poses, reached, gripper):
    positions, rotations = poses
    configurations, found = reached

    for i in np.flatnonzero(~found):
        position, rotation = gripper(configurations[i])
        off = np.linalg.norm(position - positions[i]) >= 1e-3
        assert off or (rotation * rotations[i].inv()).magnitude() >= 1e-2


def test_joint_limits_are_kept(reached, limits):
    configurations, _ = reached

    assert np.all((configurations >= limits[0]) & (configurations <= limits[1]))


def test_far_pose_is_not_reached(limits):
    positions = np.array([MIDDLE, [3.0, 0.0, 0.2]])

    configurations, found = ArmKinematics().reach(positions, Rotation.identity(2))

    assert found.tolist() == [True, False]
    assert np.all((configurations >= limits[0]) & (configurations <= limits[1]))


@pytest.mark.parametrize("rows", [slice(3, 4), slice(10, 60), slice(None, None, -1)])
def test_row_does_not_depend_on_the_others(poses, reached, rows):
    positions, rotations = poses

    configurations, found = ArmKinematics().reach(positions[rows], rotations[rows])

    assert configurations.tobytes() == reached[0][rows].tobytes()
    assert found.tolist() == reached[1][rows].tolist()


@pytest.mark.parametrize("threads", [1, 2, 3])
def test_result_does_not_depend_on_the_threads(poses, reached, threads):
    configurations, found = ArmKinematics(threads=threads).reach(*poses)

    assert configurations.tobytes() == reached[0].tobytes()
    assert found.tolist() == reached[1].tolist()


def test_nothing_to_reach_or_follow_is_fine():
    kinematics = ArmKinematics()

    configurations, found = kinematics.reach(np.zeros((0, 3)), Rotation.identity(0))
    path = kinematics.follow(np.zeros((0, 7)), np.zeros((0, 50, 3)))

    assert (configurations.shape, found.shape, path.shape) == ((0, 7), (0,), (0, 50, 7))


@pytest.mark.parametrize(
    "direction", [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0.6, 0, 0.8)]
)
def test_line_is_followed_at_constant_orientation(middle, gripper, direction):
    offsets = np.linspace(0.0, 0.15, 51)[1:, None] * np.array(direction)

    path = ArmKinematics().follow(middle, offsets[None])[0]

    start, orientation = gripper(middle[0])
    for arm, offset in zip(path, offsets, strict=True):
        position, rotation = gripper(arm)
        assert np.linalg.norm(position - (start + offset)) < 5e-4
        assert (rotation * orientation.inv()).magnitude() < 2e-3


def test_line_out_of_reach_is_followed_within_the_limits(middle, gripper, limits):
    offsets = np.linspace(0.0, 2.0, 51)[1:, None] * np.array([1.0, 0.0, 0.0])

    path = ArmKinematics().follow(middle, offsets[None])[0]

    assert np.all((path >= limits[0]) & (path <= limits[1]))
    assert gripper(path[-1])[0][0] > MIDDLE[0] + 0.1
    assert np.abs(np.diff(path, axis=0)).max() <= 0.4 + 1e-12


def test_followed_row_does_not_depend_on_the_others_nor_the_threads(reached):
    starts = reached[0][reached[1]]
    rng = np.random.default_rng(1)
    offsets = np.cumsum(rng.uniform(-2e-3, 2e-3, (len(starts), 20, 3)), axis=1)

    together = ArmKinematics(threads=2).follow(starts, offsets)
    alone = ArmKinematics(threads=1).follow(starts[5:6], offsets[5:6])

    assert alone.tobytes() == together[5:6].tobytes()


def test_arm_alone_has_the_geometry_of_the_scene(gripper):
    model = load_panda().compile()
    data = mujoco.MjData(model)
    data.qpos[:7] = HOME
    mujoco.mj_forward(model, data)

    site = data.site(GRIPPER_SITE)
    position, rotation = gripper(HOME)

    assert site.xpos.tolist() == position.tolist()
    assert rotation.as_matrix() == pytest.approx(site.xmat.reshape(3, 3), abs=1e-12)


def test_missing_assets_are_named(monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda _: None)

    with pytest.raises(LQDError, match=r"gymnasium-robotics.*run `pip install gymnasium-robotics`"):
        load_panda()
