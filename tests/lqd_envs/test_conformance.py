"""What every registered environment must be, whatever its task."""

import math
import pickle
import warnings

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.envs.mujoco.utils import check_mujoco_reset_state
from gymnasium.utils.env_checker import check_env
from gymnasium.wrappers import RecordEpisodeStatistics, TimeLimit

from lqd_envs import PAPER_TASKS, TASKS, Info, LQDError, ManipulationEnv, RenderingError, Verdict
from lqd_envs.rendering_backend import has_display
from lqd_envs.scenes.panda import HOME

IDS = sorted(spec.id for spec in gym.registry.values() if spec.namespace == "LQD")
EPISODE = 150
# A target is kept for so many control steps, or the arm would only tremble where it is.
KEPT = 15

pytestmark = pytest.mark.parametrize("task_id", IDS)


@pytest.fixture
def env(task_id):
    env = gym.make(task_id).unwrapped
    yield env
    env.close()


@pytest.fixture(scope="session")
def opengl():
    """Skips where no picture can be drawn."""
    env = ManipulationEnv(render_mode="rgb_array", width=16, height=16)
    env.reset()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # GLFW warns before MuJoCo fails
        try:
            env.render()
        except RenderingError as error:
            pytest.skip(str(error))
    env.close()


def random_actions(seed, *, steps=EPISODE):
    targets = np.random.default_rng(seed).uniform(-1.0, 1.0, (steps // KEPT + 1, 8))
    return np.repeat(targets, KEPT, axis=0)[:steps].astype(np.float32)


def onto_the_table():
    """Actions that turn the arm to its left and then press the gripper on the table."""
    actions = np.zeros((EPISODE, 8), dtype=np.float32)
    actions[:, 0] = 0.4
    actions[EPISODE // 2 :, 1] = 1.0
    return actions


def moments_of(env, actions):
    """Every bit of what follows the actions."""
    moments = []
    for action in actions:
        observation, reward, terminated, truncated, info = env.step(action)
        moments.append((observation.tobytes(), repr(info), reward, terminated, truncated))
    return moments


def episode(env, *, seed):
    observation, info = env.reset(seed=seed)
    return [(observation.tobytes(), repr(info)), *moments_of(env, random_actions(seed, steps=60))]


def play(env, trajectories, row):
    """Yield what `reset` and every `step` of a motion return, as (observation, reward, info)."""
    observation, info = env.reset(options={"arm": trajectories.plan.starts[row]})
    yield observation, 0.0, info
    for action in trajectories.plan.actions[row]:
        observation, reward, _, _, info = env.step(action)
        yield observation, reward, info


def touching(trajectories):
    return np.flatnonzero(
        trajectories.valid & trajectories.columns.gripper_contacts.any(axis=(1, 2))
    )


def test_is_one_of_the_task_table(task_id):
    assert task_id in TASKS
    assert {task.id for task in PAPER_TASKS} <= set(IDS)


def test_spec(task_id):
    spec = gym.spec(task_id)
    made = gym.make(task_id)

    assert spec.max_episode_steps == EPISODE
    assert spec.kwargs == {"task": task_id}
    assert not spec.nondeterministic
    assert isinstance(made.unwrapped, ManipulationEnv)
    assert made.spec.id == task_id
    made.close()


def test_follows_gymnasium_s_api_without_a_warning(env):
    check_env(env, skip_render_check=True)


@pytest.mark.usefixtures("opengl")
def test_pictures_follow_gymnasium_s_api_without_a_warning(env, monkeypatch):
    modes = ["human", "rgb_array"] if has_display() else ["rgb_array"]
    monkeypatch.setitem(ManipulationEnv.metadata, "render_modes", modes)

    check_env(env)


def test_reset_restores_the_whole_state(task_id):
    check_mujoco_reset_state(gym.make(task_id))


def test_two_envs_agree(task_id, env):
    other = gym.make(task_id).unwrapped

    assert episode(env, seed=3) == episode(other, seed=3)
    assert episode(env, seed=3) != episode(other, seed=4)


def test_info_has_the_same_keys_from_reset_and_step(env):
    _, first = env.reset()
    _, _, _, _, second = env.step(np.zeros(8))

    assert tuple(first) == tuple(second) == (*Info.__annotations__, "is_success", "discarded")
    for key in ("gripper_contacts", "joint_positions"):
        assert tuple(first[key]) == tuple(second[key])


def test_discarded_motion_ends_as_in_the_batch(env, discarded_motion, task_id):
    motions = discarded_motion(task_id)
    assert Verdict(int(motions.verdicts[0])).discarded
    assert motions.task.success(motions.columns)[0]
    moments = list(play(env, motions, 0))

    perceived = [{key: info[key] for key in Info.__annotations__} for _, _, info in moments]
    assert perceived == motions.infos(0)
    discarded = [info["discarded"] for _, _, info in moments]
    first = discarded.index(True)
    assert first > 0
    assert all(discarded[first:])
    assert [reward for _, reward, _ in moments[first:]] == [0.0] * (76 - first)
    assert not any(info["is_success"] for _, _, info in moments[first:])
    assert moments[-1][2]["is_success"] == motions.success()[0]
    _, info = env.reset()
    assert info["discarded"] is False


def test_discarded_motion_is_that_of_single_envs_in_the_vector_env(env, discarded_motion, task_id):
    motions = discarded_motion(task_id)
    envs = gym.make_vec(task_id, num_envs=2, autoreset_mode="SameStep", max_episode_steps=75)
    envs.reset(options={"arm": np.array([motions.plan.starts[0], HOME])})
    single = [info for _, _, info in play(env, motions, 0)][1:]
    for action, info in zip(motions.plan.actions[0], single, strict=True):
        _, rewards, _, truncations, infos = envs.step(np.array([action, np.zeros(8)]))
        ended = infos["final_info"] if truncations[0] else infos
        for key in ("is_success", "discarded"):
            assert ended[key][0] == info[key]
        assert rewards[0] == float(info["is_success"])

    assert truncations.all()
    assert ended["discarded"][0]
    assert infos["discarded"].tolist() == [False, False]
    assert infos["_discarded"].tolist() == [True, True]
    envs.close()


def numbers_in(value):
    if isinstance(value, dict):
        value = tuple(value.values())
    return [n for part in value for n in numbers_in(part)] if isinstance(value, tuple) else [value]


def test_everything_is_finite_and_within_its_space_in_contact(env, motions_of, task_id):
    trajectories = motions_of(task_id)
    rows = touching(trajectories)[:6]
    moments = [moment for row in rows for moment in play(env, trajectories, row)]
    for actions in (random_actions(0), random_actions(1), onto_the_table()):
        env.reset()
        for action in actions:
            observation, reward, _, truncated, info = env.step(action)
            moments.append((observation, reward, info))
            assert not truncated

    assert any(any(info["gripper_contacts"].values()) for _, _, info in moments)
    assert any(info["robot_table_contact"] for _, _, info in moments)
    for observation, reward, info in moments:
        assert env.observation_space.contains(observation)
        assert np.isfinite(observation).all()
        assert math.isfinite(reward)
        assert all(math.isfinite(number) for number in numbers_in(info))
        assert {type(number) for number in numbers_in(info)} == {float, bool}


def test_observation_has_a_name_for_each_entry(env):
    schema = TASKS[env.spec.id].schema
    names = env.observation_names

    assert len(set(names)) == len(names)
    assert env.observation_space.shape == (len(names),)
    assert len(names) == 7 + 7 + 2 + 7 + 7 + len(schema.joints) + 2 + len(schema.links)


class CrashError(Exception):
    """Stands for whatever goes wrong in the middle of an episode."""


def test_reset_is_reproducible_after_a_crash_in_the_middle(env, monkeypatch):
    first = episode(env, seed=5)

    def crash(*_):
        raise CrashError

    env.reset(seed=9)
    moments_of(env, random_actions(9, steps=20))
    with monkeypatch.context() as patch:
        patch.setattr(type(env), "_observe", crash)
        with pytest.raises(CrashError):
            env.step(np.ones(8))
    assert episode(env, seed=5) == first

    with pytest.raises(LQDError, match="expected an action of 8 finite numbers"):
        env.step(np.full(8, np.nan))
    assert episode(env, seed=5) == first


def test_close_twice(task_id):
    env = gym.make(task_id)
    env.reset()

    env.close()
    env.close()


@pytest.mark.parametrize("steps", [0, 30])
def test_pickled_env_goes_on_where_it_was(env, steps):
    env.reset(seed=1)
    moments_of(env, random_actions(1, steps=steps))

    copy = pickle.loads(pickle.dumps(env))

    actions = random_actions(2, steps=60)
    assert moments_of(copy, actions) == moments_of(env, actions)
    assert episode(copy, seed=4) == episode(env, seed=4)


@pytest.mark.usefixtures("opengl")
def test_env_that_has_drawn_can_be_pickled_and_draws_again(task_id):
    env = gym.make(task_id, render_mode="rgb_array", width=64, height=48).unwrapped
    env.reset(seed=1)
    picture = env.render()

    copy = pickle.loads(pickle.dumps(env))

    assert np.array_equal(copy.render(), picture)
    env.close()
    copy.close()


@pytest.mark.usefixtures("opengl")
def test_pictures(task_id):
    env = gym.make(task_id, render_mode="rgb_array", width=160, height=120)
    env.reset()
    first = env.render()
    for action in random_actions(0, steps=30):
        env.step(action)

    assert first.shape == (120, 160, 3)
    assert first.dtype == np.uint8
    assert first.std() > 10.0
    assert (env.render() != first).any()
    env.close()


def test_episode_ends_after_150_steps_and_its_statistics_are_recorded(task_id):
    env = gym.make(task_id, reward="dense")
    assert isinstance(env, TimeLimit)
    env = RecordEpisodeStatistics(env)
    env.reset()
    steps = [env.step(action) for action in random_actions(6)]

    assert [step[2:4] for step in steps] == [(False, False)] * (EPISODE - 1) + [(False, True)]
    assert steps[-1][4]["episode"]["l"] == EPISODE
    assert steps[-1][4]["episode"]["r"] == pytest.approx(sum(step[1] for step in steps), rel=1e-6)


def test_time_limit_can_be_another(task_id):
    env = gym.make(task_id, max_episode_steps=7)
    env.reset()

    ends = [env.step(np.zeros(8))[3] for _ in range(7)]

    assert ends == [False] * 6 + [True]
