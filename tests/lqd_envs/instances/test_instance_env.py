"""Instances as Gymnasium environments: the same bits in every way of simulating them."""

import pickle
import warnings
from dataclasses import replace

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.envs.mujoco.utils import check_mujoco_reset_state
from gymnasium.envs.registration import EnvSpec
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode

from lqd_envs import PAPER_TASKS, Info, LQDError, ManipulationVectorEnv, get_task, rollout
from lqd_envs.instances import KINDS, Instance, InstanceError, Obstacle, generate_instances
from lqd_envs.scenes.panda import HOME

IDS = [task.id for task in PAPER_TASKS]
FAUCET, PUSH = "LQD/Faucet-v0", "LQD/Push-v0"
BY_KIND = {
    (task_id, kind): generate_instances(task_id, kind, count=2, seed=0)[1]
    for task_id in IDS
    for kind in KINDS
}
OBSTRUCTED = generate_instances(FAUCET, "obstacles", count=1, seed=0)[0]


def play(env, motions, row):
    """What is perceived, and the successes and rewards of a motion in an env."""
    _, info = env.reset(options={"arm": motions.plan.starts[row]})
    infos, rewards = [info], [0.0]
    for action in motions.plan.actions[row]:
        _, reward, _, _, info = env.step(action)
        infos.append(info)
        rewards.append(reward)
    perceived = [{key: info[key] for key in Info.__annotations__} for info in infos]
    return perceived, [info["is_success"] for info in infos], rewards


@pytest.mark.parametrize(("task_id", "kind"), BY_KIND)
def test_follows_gymnasium_s_api_without_a_warning(task_id, kind):
    env = gym.make(task_id, instance=BY_KIND[task_id, kind])

    check_env(env.unwrapped, skip_render_check=True)
    check_mujoco_reset_state(env)
    env.close()


@pytest.mark.parametrize(("task_id", "kind"), [*BY_KIND, (FAUCET, "obstructed")])
def test_env_vector_env_and_rollout_agree_bit_for_bit(solving, task_id, kind):
    instance = BY_KIND.get((task_id, kind), OBSTRUCTED)
    motions = rollout(instance.apply(get_task(task_id)), solving(task_id).solutions)
    rows = np.flatnonzero(motions.valid)[:3]
    motions = motions.rows(rows)
    n = len(rows)
    assert n

    env = gym.make(task_id, instance=instance, reward="dense").unwrapped
    envs = gym.make_vec(
        task_id,
        num_envs=n,
        instance=instance,
        reward="dense",
        vectorization_mode="vector_entry_point",
    )
    _, info = envs.reset(options={"arm": motions.plan.starts})
    columns, successes, rewards = [info], [info["is_success"]], [np.zeros(n)]
    for moment in range(motions.plan.actions.shape[1]):
        _, reward, _, _, info = envs.step(motions.plan.actions[:, moment])
        columns.append(info)
        successes.append(info["is_success"])
        rewards.append(reward)

    for row in range(n):
        infos, single_successes, single_rewards = play(env, motions, row)
        assert infos == motions.infos(row)
        assert single_successes == [bool(success[row]) for success in successes]
        assert single_rewards == [reward[row] for reward in rewards]
        for key in ("object_position", "gripper_position", "gripper_orientation"):
            assert [tuple(info[key][row]) for info in columns] == [info[key] for info in infos]
        assert single_successes[-1] == motions.success()[row]
    env.close()
    envs.close()


def obstructed_motion(solving):
    """A motion that touches an obstacle and that the expert would call a success, alone."""
    motions = rollout(OBSTRUCTED.apply(get_task(FAUCET)), solving(FAUCET).solutions)
    expert = get_task(FAUCET).success(motions.columns)
    return motions.rows(np.flatnonzero(expert & motions.valid & motions.obstructed)[:1])


@pytest.mark.parametrize("reward", ["sparse", "dense"])
def test_after_a_touch_there_is_no_success_and_no_reward_until_the_reset(solving, reward):
    motions = obstructed_motion(solving)
    assert len(motions) == 1
    env = gym.make(FAUCET, instance=OBSTRUCTED, reward=reward).unwrapped

    _, successes, rewards = play(env, motions, 0)
    assert not successes[-1]
    assert rewards[-1] == 0.0
    assert env.step(motions.plan.actions[0, -1])[4]["discarded"]
    assert not env.reset()[1]["discarded"]
    # Without the boxes the same motion is a success.
    plain = gym.make(FAUCET, reward=reward).unwrapped
    _, successes, rewards = play(plain, motions, 0)
    assert successes[-1]
    assert rewards[-1] == 1.0


@pytest.mark.parametrize("mode", [AutoresetMode.SAME_STEP, AutoresetMode.NEXT_STEP])
def test_a_touch_is_forgotten_by_an_autoreset_and_by_nothing_else(solving, mode):
    motions = obstructed_motion(solving)
    steps = motions.plan.actions.shape[1]
    # The second env is truncated with the first, so that both are reset.
    envs = ManipulationVectorEnv(
        2, FAUCET, instance=OBSTRUCTED, autoreset_mode=mode, max_episode_steps=steps
    )
    envs.reset(options={"arm": np.array([motions.plan.starts[0], HOME])})
    idle = np.zeros(8)
    for action in motions.plan.actions[0]:
        infos = envs.step(np.array([action, idle]))[4]
    ended = infos["final_info"] if mode is AutoresetMode.SAME_STEP else infos
    assert ended["discarded"].tolist() == [True, False]

    assert envs.step(np.zeros((2, 8)))[4]["discarded"].tolist() == [False, False]
    envs.close()


@pytest.mark.parametrize("kind", KINDS)
def test_spec_round_trips_through_json_and_pickle(kind):
    instance = BY_KIND[FAUCET, kind]
    env = gym.make(FAUCET, instance=instance)
    task = env.unwrapped._scene.task

    assert env.spec.kwargs["instance"] == instance
    for spec in (
        EnvSpec.from_json(env.spec.to_json()),
        pickle.loads(pickle.dumps(env.spec)),
    ):
        again = gym.make(spec)
        assert again.unwrapped._scene.task == task == instance.apply(get_task(FAUCET))
        again.close()
    env.close()


def test_pickled_env_goes_on_where_it_was(solving):
    motions = obstructed_motion(solving)
    env = gym.make(FAUCET, instance=OBSTRUCTED).unwrapped
    env.reset(options={"arm": motions.plan.starts[0]})
    for action in motions.plan.actions[0][:60]:
        env.step(action)
    copy = pickle.loads(pickle.dumps(env))

    for action in motions.plan.actions[0][60:]:
        assert repr(copy.step(action)) == repr(env.step(action))


def test_instance_as_a_dictionary():
    instance = BY_KIND[PUSH, "obstacles"]
    env = gym.make(PUSH, instance=instance.to_dict())

    assert env.unwrapped._scene.task == instance.apply(get_task(PUSH))
    env.close()


def test_instance_of_another_task_is_refused():
    with pytest.raises(InstanceError, match="an instance of LQD/Push-v0, but got one of LQD/Fau"):
        gym.make(PUSH, instance=OBSTRUCTED)
    with pytest.raises(InstanceError, match="an instance as a dictionary, but got 'hard'"):
        gym.make_vec(PUSH, num_envs=1, instance="hard", vectorization_mode="vector_entry_point")


def test_start_inside_an_obstacle_is_refused():
    box = Obstacle((0.4634, 0.0, 0.45), (0.05, 0.05, 0.05))
    env = gym.make(PUSH, instance=Instance(PUSH, obstacles=(box,)))

    text = r"got the usual one with .*obstacle: give another as the argument `start_arm`, or to a"
    with pytest.raises(LQDError, match=text):
        env.reset()
    with pytest.raises(LQDError, match=r"got an arm configuration with .*: start further away"):
        env.reset(options={"arm": HOME})


def test_boxes_are_drawn():
    instance = BY_KIND[PUSH, "obstacles"]
    pictures = []
    for some in (instance, replace(instance, obstacles=())):
        env = gym.make(PUSH, instance=some, render_mode="rgb_array", width=160, height=120)
        env.reset()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # GLFW warns before MuJoCo fails
            try:
                pictures.append(env.render())
            except LQDError as error:
                pytest.skip(str(error))
        env.close()

    assert (pictures[0] != pictures[1]).any(axis=-1).mean() > 0.002


def test_a_touch_still_counts_when_another_env_is_reset_in_the_same_step(solving):
    motions = obstructed_motion(solving)
    earlier, steps = 5, motions.plan.actions.shape[1]
    envs = ManipulationVectorEnv(
        2,
        FAUCET,
        instance=OBSTRUCTED,
        autoreset_mode=AutoresetMode.SAME_STEP,
        max_episode_steps=earlier + steps,
    )
    envs.reset()
    for _ in range(earlier):
        envs.step(np.zeros((2, 8)))
    first = np.array([True, False])
    envs.reset(options={"arm": motions.plan.starts[0], "reset_mask": first})
    for action in motions.plan.actions[0]:
        _, _, _, truncated, infos = envs.step(np.array([action, np.zeros(8)]))

    assert truncated.tolist() == [False, True]
    assert infos["joint_positions"]["hot_tap"][0] > 0.314
    assert infos["is_success"].tolist() == [False, False]
    envs.close()
