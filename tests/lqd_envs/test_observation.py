import re

import mujoco
import numpy as np
import pytest

from lqd_envs import ManipulationEnv
from lqd_envs.observation import Observation
from lqd_envs.scenes.panda import HOME


@pytest.fixture(scope="module")
def env():
    env = ManipulationEnv()
    yield env
    env.close()


@pytest.fixture(scope="module")
def middle(env, turning):
    """Observation and info in the middle of a motion, with the hot tap in the gripper's way."""
    env.reset(options={"arm": turning.plan.starts[0]})
    steps = [env.step(action) for action in turning.plan.actions[0][:50]]
    return dict(zip(env.observation_names, steps[-1][0], strict=True)), steps[-1][4]


def test_one_name_for_each_entry(env):
    names = env.observation_names

    assert env.observation_space.shape == (len(names),)
    assert len(set(names)) == len(names) == 7 + 7 + 2 + 7 + 7 + 2 + 2 + 3


def test_bounds_are_finite_and_float64(env):
    space = env.observation_space

    assert space.dtype == np.float64
    assert np.isfinite(space.low).all()
    assert np.isfinite(space.high).all()
    assert np.all(space.low < space.high)


@pytest.mark.parametrize("seed", range(3))
def test_observations_are_within_the_space(env, seed):
    env.action_space.seed(seed)
    observation, _ = env.reset()
    assert env.observation_space.contains(observation)

    for _ in range(150):
        observation, *_ = env.step(env.action_space.sample())
        assert env.observation_space.contains(observation)


def test_observations_of_motions_are_hardly_ever_clipped(env, trajectories):
    low, high = env.observation_space.low, env.observation_space.high
    flags = np.array(["touches" in name for name in env.observation_names])
    unit = np.array(["quaternion" in name for name in env.observation_names])

    for i in np.flatnonzero(trajectories.valid)[:10]:
        env.reset(options={"arm": trajectories.plan.starts[i]})
        for action in trajectories.plan.actions[i]:
            observation = env.step(action)[0]
            on_bound = (observation == low) | (observation == high)
            assert not on_bound[~flags & ~unit].any()


def test_far_values_are_clipped_to_the_bounds(scene, started):
    data = started(HOME)
    layout = Observation.of(scene)

    (observation,) = layout.vector(
        scene,
        qpos=np.full((1, scene.model.nq), 50.0),
        qvel=np.full((1, scene.model.nv), -1e3),
        sensordata=data.sensordata[None],
        columns=scene.sensors.columns(data.sensordata[None, None]),
    )

    assert np.array_equal(observation[:7], layout.high[:7])
    assert np.array_equal(observation[7:14], layout.low[7:14])
    assert np.array_equal(observation[14:16], layout.high[14:16])


def test_joints_are_those_of_the_simulation(env, middle):
    values, _ = middle

    for name, value in values.items():
        found = re.fullmatch(r"(position|velocity) of (robot:\w+) \(rad(?:/s)?\)", name)
        if found:
            kind, joint = found.groups()
            state = env.data.joint(joint)
            assert value == (state.qpos if kind == "position" else state.qvel)[0]
    assert (
        values["position of the left finger (m)"]
        == env.data.joint("robot:panda0_finger_joint1").qpos.item()
    )
    assert (
        values["position of the right finger (m)"]
        == env.data.joint("robot:panda0_finger_joint2").qpos.item()
    )


def test_perception_is_that_of_the_info(middle):
    values, info = middle

    for frame in ("gripper", "object"):
        position = tuple(values[f"{frame} {axis} (m)"] for axis in "xyz")
        assert position == info[f"{frame}_position"]
    assert values["hot_tap (rad)"] == info["joint_positions"]["hot_tap"] > 0.1
    assert values["cold_tap (rad)"] == info["joint_positions"]["cold_tap"]
    assert values["object touches table"] == info["object_table_contact"] == 1.0
    assert values["robot touches table"] == info["robot_table_contact"] == 0.0
    touches = {link: bool(values[f"gripper touches {link}"]) for link in info["gripper_contacts"]}
    assert touches == info["gripper_contacts"]
    assert touches["hot_tap"]


def test_quaternions_are_those_of_the_frames(env, middle):
    values, _ = middle
    expected = np.empty(4)
    mujoco.mju_mat2Quat(expected, env.data.site("gripper_center").xmat)
    expected *= np.copysign(1.0, expected[0])

    assert [values[f"gripper quaternion {part}"] for part in "wxyz"] == pytest.approx(expected)
    assert [values[f"object quaternion {part}"] for part in "wxyz"] == [1.0, 0.0, 0.0, 0.0]


def test_quaternion_does_not_jump_to_its_opposite(env, trajectories):
    places = [k for k, name in enumerate(env.observation_names) if name == "gripper quaternion w"]

    for start in trajectories.plan.starts[trajectories.valid]:
        observation, _ = env.reset(options={"arm": start})
        assert observation[places[0]] >= 0.0
