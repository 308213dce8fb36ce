from dataclasses import replace

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.envs.mujoco.utils import check_mujoco_reset_state
from gymnasium.utils.env_checker import check_env
from gymnasium.wrappers import TimeLimit

from lqd_envs import (
    Info,
    LQDError,
    ManipulationEnv,
    MotionPlan,
    ResetError,
    UnknownTaskError,
    Verdict,
)
from lqd_envs.rollout import simulate
from lqd_envs.scenes.panda import HOME

ID = "LQD/Faucet-v0"


@pytest.fixture
def env():
    env = ManipulationEnv()
    yield env
    env.close()


def perceived(info):
    """The eight keys of the perception API, as a text that shows every bit of them."""
    return repr({key: info[key] for key in Info.__annotations__})


def still(scene):
    """The plan of one motion in which the arm stays at home."""
    starts = np.array([HOME])
    action = scene.action_map.actions(starts, finger_target=np.full(1, 0.04))
    return MotionPlan(
        verdicts=np.array([Verdict.VALID], dtype=np.uint8),
        starts=starts,
        actions=np.repeat(action[:, None], 75, axis=1),
    )


def open_by_a_spring(model, stiffness):
    """Let a spring open the hot tap."""
    joint = model.joint("hot_tap")
    model.jnt_stiffness[joint.id] = stiffness
    model.qpos_spring[joint.qposadr[0]] = 2.0


def episode(env, *, seed, steps=60):
    """Every bit of an episode of random actions."""
    rng = np.random.default_rng(seed)
    observation, info = env.reset(seed=seed)
    moments = [(observation.tobytes(), repr(info))]
    for _ in range(steps):
        observation, reward, terminated, truncated, info = env.step(
            rng.uniform(-1.0, 1.0, 8).astype(np.float32)
        )
        moments.append((observation.tobytes(), repr(info), reward, terminated, truncated))
    return moments


def test_follows_gymnasium_s_api():
    # Not its pictures, since it also tries to open a window.
    check_env(gym.make(ID).unwrapped, skip_render_check=True)


def test_reset_restores_the_whole_state():
    check_mujoco_reset_state(gym.make(ID))


@pytest.mark.parametrize("task_id", [ID, f"lqd_envs:{ID}"])
def test_is_made_by_its_id(task_id):
    made = gym.make(task_id)

    assert isinstance(made.unwrapped, ManipulationEnv)
    assert made.spec.id == ID
    assert isinstance(made, TimeLimit)
    made.close()


def test_motion_is_the_same_bit_for_bit_as_in_the_batch(env, trajectories):
    rows = np.flatnonzero(trajectories.valid)
    assert len(trajectories) > 200
    assert len(rows) > 50
    moved = trajectories.columns.joint_positions[rows].any()
    touched = trajectories.columns.gripper_contacts[rows].any()
    assert moved
    assert touched

    success = trajectories.success()
    for i in rows:
        infos = [env.reset(options={"arm": trajectories.plan.starts[i]})[1]]
        infos += [env.step(action)[4] for action in trajectories.plan.actions[i]]
        assert [perceived(info) for info in infos] == [
            repr(dict(info)) for info in trajectories.infos(i)
        ]
        assert infos[-1]["is_success"] == success[i]
        assert not any(info["discarded"] for info in infos)


def test_motion_that_succeeds_is_rewarded(env, turning):
    env.reset(options={"arm": turning.plan.starts[0]})
    steps = [env.step(action) for action in turning.plan.actions[0]]

    assert perceived(steps[-1][4]) == repr(dict(turning.infos(0)[-1]))
    for _, reward, terminated, truncated, info in steps:
        angle = info["joint_positions"]["hot_tap"]
        assert info["is_success"] is (angle >= 0.314)
        assert type(reward) is float
        assert reward == float(info["is_success"])
        assert (terminated, truncated) == (False, False)
    assert steps[-1][1] == 1.0


def test_two_envs_agree():
    assert episode(ManipulationEnv(), seed=3) == episode(ManipulationEnv(), seed=3)


def test_other_actions_give_another_episode(env):
    assert episode(env, seed=3) != episode(env, seed=4)


def test_episode_comes_back_after_a_reset_in_the_middle(env):
    first = episode(env, seed=3)
    env.reset()
    for _ in range(7):
        env.step(np.ones(8))

    assert episode(env, seed=3) == first


def test_episode_comes_back_after_errors(env):
    first = episode(env, seed=3)
    with pytest.raises(ResetError):
        env.reset(options={"arm": (0.0, 0.6, 0.0, -2.2, 0.0, 0.33, 0.0)})
    with pytest.raises(LQDError, match=r"expected reset\(\) before the first step\(\)"):
        env.step(np.zeros(8))

    assert episode(env, seed=3) == first

    with pytest.raises(LQDError):
        env.step(np.zeros(3))

    assert episode(env, seed=3) == first


def test_episode_comes_back_after_a_divergence(env, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)  # where MuJoCo writes its log
    first = episode(env, seed=3)
    env.data.qvel[:] = 1e12
    env.step(np.zeros(8))

    assert episode(env, seed=3) == first


def test_refused_options_leave_the_episode_alone(env):
    env.reset()
    with pytest.raises(ResetError, match="expected the option 'arm' at most"):
        env.reset(options={"leg": 1})

    _, _, _, _, after = env.step(np.zeros(8))

    env.reset()
    assert repr(env.step(np.zeros(8))[4]) == repr(after)


def test_episode_is_truncated_after_150_steps():
    env = gym.make(ID)
    env.reset()
    ends = [env.step(env.action_space.sample())[2:4] for _ in range(150)]

    assert ends[:-1] == [(False, False)] * 149
    assert ends[-1] == (False, True)


def test_start_is_the_documented_one(env):
    observation, info = env.reset()

    assert observation[:7] == pytest.approx(HOME)
    assert not observation[7:14].any()
    assert info["joint_positions"] == {"hot_tap": 0.0, "cold_tap": 0.0}
    assert not any(info["gripper_contacts"].values())
    assert info["is_success"] is False


def test_info_has_ten_plain_keys(env):
    _, info = env.reset()

    assert list(info) == [
        "object_position",
        "object_orientation",
        "object_table_contact",
        "robot_table_contact",
        "gripper_position",
        "gripper_orientation",
        "gripper_contacts",
        "joint_positions",
        "is_success",
        "discarded",
    ]
    for key in ("is_success", "discarded", "object_table_contact", "robot_table_contact"):
        assert type(info[key]) is bool


def test_start_of_one_s_own(env):
    arm = np.array([0.2, -0.5, 0.1, -2.0, 0.3, 1.0, -0.4])

    observation, _ = env.reset(options={"arm": arm.tolist()})

    assert observation[:7].tolist() == arm.tolist()
    assert env.reset()[0][:7].tolist() == list(HOME)


def test_options_may_be_empty(env):
    usual = env.reset()[0].tobytes()

    assert env.reset(options={})[0].tobytes() == usual
    assert env.reset(options={"arm": HOME})[0].tobytes() == usual


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"leg": 1}, r"expected the option 'arm' at most, got 'leg'$"),
        ({"arm": HOME, "b": 0, "a": 0}, r"expected the option 'arm' at most, got 'a', 'b'$"),
        ({"arm": HOME[:6]}, r"expected the option 'arm' to be 7 finite joint positions in rad"),
        ({"arm": [HOME]}, r"7 finite joint positions in rad, got \[\(0\.0, -0\.3"),
        ({1: 2}, r"expected the option 'arm' at most, got 1$"),
        (5, r"expected options as a dictionary or None, got 5: write them"),
        ([HOME], r"expected options as a dictionary or None, got \[\(0\.0"),
        ((), r"expected options as a dictionary or None, got \(\): write them"),
        ({"arm": (*HOME[:6], 10**400)}, r"7 finite joint positions in rad, got \(0\.0"),
        ({"arm": "abc"}, r"7 finite joint positions in rad, got 'abc'"),
        ({"arm": [[1], 2]}, r"7 finite joint positions in rad, got \[\[1\], 2\]"),
        ({"arm": None}, r"7 finite joint positions in rad, got None"),
        ({"arm": (*HOME[:6], np.nan)}, r"7 finite joint positions in rad, got \(.*nan\)"),
        ({"arm": (*HOME[:6], np.inf)}, r"7 finite joint positions in rad, got \(.*inf\)"),
        (
            {"arm": (0.0, -0.3, 0.0, -0.2, 0.0, 0.33, 0.0)},
            r"expected arm joint 4 within \[-3\.0718, -0\.4000\] rad, got -0\.2000",
        ),
        (
            {"arm": (2.9, -0.3, 0.0, -2.2, 0.0, 0.33, 0.0)},
            r"expected arm joint 1 within \[-2\.8973, 2\.8973\] rad, got 2\.9000",
        ),
        (
            {"arm": (0.0, 0.6, 0.0, -2.2, 0.0, 0.33, 0.0)},
            r"expected a start at which the robot touches nothing, .*start further away",
        ),
    ],
)
def test_wrong_options_are_refused(env, options, text):
    with pytest.raises(ResetError, match=text) as caught:
        env.reset(options=options)

    assert isinstance(caught.value, LQDError)
    assert isinstance(caught.value, ValueError)


def test_overlapping_starts_are_refused(env, trajectories):
    for i in np.flatnonzero(trajectories.verdicts == Verdict.OVERLAPPING)[:20]:
        with pytest.raises(ResetError, match="link 6 or 7 inside the table, the object or an obs"):
            env.reset(options={"arm": trajectories.plan.starts[i]})


@pytest.mark.parametrize(
    "action",
    [
        np.zeros(7),
        np.zeros((1, 8)),
        0.0,
        [np.nan] * 8,
        [0.0] * 7 + [np.inf],
        None,
        "abc",
        ["a"] * 8,
        [10**400] * 8,
    ],
)
def test_wrong_action_is_refused(env, action):
    env.reset()

    with pytest.raises(LQDError, match=r"expected an action of 8 finite numbers in \[-1, 1\], got"):
        env.step(action)


def test_step_before_reset_is_refused(env):
    with pytest.raises(LQDError, match=r"expected reset\(\) before .*: call env\.reset\(\) once"):
        env.step(np.zeros(8))


def test_actions_outside_are_clipped(env):
    env.reset()
    clipped = env.step(np.ones(8))[0].tobytes()
    env.reset()

    assert env.step(np.full(8, 100.0))[0].tobytes() == clipped


def test_divergence_ends_the_episode_and_is_no_success(env, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)  # where MuJoCo writes its log
    env.reset()
    env.data.qvel[:] = 1e12

    _, reward, terminated, truncated, info = env.step(np.zeros(8))

    assert (reward, terminated, truncated, info["is_success"]) == (0.0, False, True, False)
    assert info["discarded"] is True
    assert env.step(np.zeros(8))[4]["discarded"] is True
    assert env.reset()[1]["discarded"] is False
    assert not env.step(np.zeros(8))[3]


@pytest.mark.parametrize("reward", ["sparse", "dense"])
@pytest.mark.parametrize(
    ("stiffness", "verdict"), [(10.0, Verdict.TOO_FAST), (1e12, Verdict.DIVERGED)]
)
def test_motion_that_only_a_solver_makes_is_no_success(
    reward, stiffness, verdict, scene, monkeypatch, tmp_path
):
    monkeypatch.chdir(tmp_path)  # where MuJoCo writes its log
    env = ManipulationEnv(reward=reward)
    open_by_a_spring(env.model, stiffness)
    motions = simulate(replace(scene, physics=env.model), np.zeros((1, 9)), still(scene))
    assert motions.verdicts.tolist() == [verdict]

    env.reset(options={"arm": HOME})
    steps = [env.step(action) for action in motions.plan.actions[0]]

    discarded = [info["discarded"] for *_, info in steps]
    first = discarded.index(True)
    assert discarded == [False] * first + [True] * (75 - first)
    assert not any(info["is_success"] for *_, info in steps[first:])
    assert [reward for _, reward, *_ in steps[first:]] == [0.0] * (75 - first)
    assert steps[-1][4]["is_success"] == motions.success()[0]
    # Where it did not diverge, the expert alone would be content.
    assert (steps[-1][4]["joint_positions"]["hot_tap"] > 0.314) == (verdict is Verdict.TOO_FAST)


def test_model_is_the_env_s_own(env, scene):
    def angle_at_the_end(some):
        some.reset()
        for action in still(scene).actions[0]:
            info = some.step(action)[4]
        return info["joint_positions"]["hot_tap"]

    other = ManipulationEnv()
    before = scene.model.jnt_stiffness.copy()
    open_by_a_spring(env.model, 0.12)

    assert angle_at_the_end(env) > 0.1
    assert angle_at_the_end(other) == angle_at_the_end(ManipulationEnv()) == 0.0
    assert (scene.model.jnt_stiffness == before).all()


def test_env_without_gymnasium_s_time_limit_goes_on(env):
    env.reset()

    assert not any(env.step(np.zeros(8))[3] for _ in range(160))


@pytest.mark.parametrize(("width", "height"), [(0, 480), (2000, 100), (640, 5000), (-1, 5)])
def test_sizes_that_cannot_be_drawn_are_refused(width, height):
    with pytest.raises(LQDError, match=r"expected pictures of 1 x 1 to 1920 x 1440 pixels, got"):
        ManipulationEnv(width=width, height=height)


@pytest.mark.parametrize(
    ("width", "height"), [("a", 480), (640.5, 480), (640, None), (True, 480), ([64], [48])]
)
def test_sizes_that_are_no_whole_numbers_are_refused(width, height):
    with pytest.raises(LQDError, match=r"expected width and height to be whole numbers of pixels"):
        ManipulationEnv(width=width, height=height)


def test_picture_before_reset_is_refused():
    env = ManipulationEnv(render_mode="rgb_array")

    with pytest.raises(LQDError, match=r"expected reset\(\) before the first render\(\): call env"):
        env.render()


def test_step_lasts_20_ms(env):
    env.reset()
    env.step(np.zeros(8))

    assert env.data.time == pytest.approx(0.02)
    assert env.metadata["render_fps"] == 50


def test_infos_and_observations_are_one_s_own(env):
    observation, info = env.reset()
    kept = observation.copy(), repr(info)
    for _ in range(10):
        env.step(np.ones(8))

    assert observation.tobytes() == kept[0].tobytes()
    assert repr(info) == kept[1]


def test_unknown_task_names_the_known_ones():
    with pytest.raises(UnknownTaskError, match=r"got 'LQD/Kettle-v0': known tasks are LQD/"):
        ManipulationEnv("LQD/Kettle-v0")
    with pytest.raises(UnknownTaskError, match=r"got \['LQD/Push-v0'\]: known tasks are LQD/"):
        ManipulationEnv(["LQD/Push-v0"])


def test_unknown_render_mode_names_the_known_ones():
    with pytest.raises(LQDError, match=r"one of \['human', 'rgb_array'\] or None, got 'ansi'"):
        ManipulationEnv(render_mode="ansi")
    with pytest.raises(LQDError, match=r"or None, got \['human'\]"):
        ManipulationEnv(render_mode=["human"])


def test_close_twice(env):
    env.reset()
    env.close()
    env.close()
