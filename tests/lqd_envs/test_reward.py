import math

import gymnasium as gym
import mujoco
import numpy as np
import pytest

from lqd_envs import TASKS, Columns, LQDError, ManipulationEnv
from lqd_envs.reward import REWARDS, get_reward
from lqd_envs.scene import load_scene
from lqd_envs.scenes.panda import FINGER_SQUEEZE, HOME

GRASP, FAUCET, DRAWER, PUSH = "LQD/Grasp-v0", "LQD/Faucet-v0", "LQD/Drawer-v0", "LQD/Push-v0"
IDS = (GRASP, FAUCET, DRAWER, PUSH)
MUG_AT = (0.5, 0.0, 0.0)
# Where the gripper should come to at the start, by the tasks' pages.
TARGETS = {
    GRASP: (0.5, 0.0, 0.04),
    FAUCET: (0.5, 0.086, 0.14),
    DRAWER: (0.505, 0.0, 0.11),
    PUSH: (0.5, 0.0, 0.04),
}
FAR = (5.0, 5.0, 5.0)


def moments(task_id, n, **last):
    """Columns of `n` motions of two moments: the start, and what is given."""
    schema = TASKS[task_id].schema
    shapes = {
        "object_position": (3,),
        "object_orientation": (3,),
        "object_table_contact": (),
        "robot_table_contact": (),
        "gripper_position": (3,),
        "gripper_orientation": (3,),
        "gripper_contacts": (len(schema.links),),
        "joint_positions": (len(schema.joints),),
    }
    columns = {name: np.zeros((n, 2, *shape)) for name, shape in shapes.items()}
    columns["object_position"][:] = MUG_AT
    columns["object_table_contact"][:] = True
    columns["gripper_position"][:] = FAR
    for name, values in last.items():
        columns[name][:, -1] = values
    flags = ("object_table_contact", "robot_table_contact", "gripper_contacts")
    typed = {name: v.astype(bool) if name in flags else v for name, v in columns.items()}
    return Columns(schema=schema, **typed)


def dense(task_id, n, **last):
    return REWARDS["dense"](TASKS[task_id], moments(task_id, n, **last))


def moved(shares, *, by):
    """(n, 3): where the mug is when it has moved some shares of a way."""
    return np.add(MUG_AT, np.outer(shares, by))


SHARES = np.linspace(0.0, 0.999, 40)
PROGRESS = {
    GRASP: {"object_position": moved(SHARES, by=(0.0, 0.0, 0.02)), "gripper_contacts": 1.0},
    FAUCET: {"joint_positions": np.outer(SHARES, (0.314, 0.0))},
    DRAWER: {"joint_positions": np.outer(SHARES, (0.10,))},
    PUSH: {"object_position": moved(SHARES, by=(0.03, -0.04, 0.0))},
}
DONE = {
    GRASP: {
        "object_position": (0.5, 0.0, 0.05),
        "gripper_contacts": 1.0,
        "object_table_contact": 0.0,
    },
    FAUCET: {"joint_positions": (0.314, 0.0)},
    DRAWER: {"joint_positions": (0.10,)},
    PUSH: {"object_position": (0.53, -0.0401, 0.0)},
}


@pytest.mark.parametrize("task_id", IDS)
def test_dense_reward_grows_as_the_gripper_comes_near(task_id):
    distances = np.append(np.geomspace(2.0, 1e-3, 40), 0.0)
    for direction in (1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.6, 0.8):
        where = np.add(TARGETS[task_id], np.outer(distances, direction))

        rewards = dense(task_id, len(where), gripper_position=where)

        assert (np.diff(rewards) > 0.0).all()
        assert rewards == pytest.approx(np.exp(-distances / 0.1) / 8, abs=1e-12)


@pytest.mark.parametrize("task_id", IDS)
def test_dense_reward_grows_as_the_task_is_done(task_id):
    rewards = dense(task_id, len(SHARES), **PROGRESS[task_id])

    assert (np.diff(rewards) > 0.0).all()
    assert 0.0 <= rewards[0] < rewards[-1] == pytest.approx(3 / 8, abs=1e-3)


def test_touching_the_mug_is_half_of_holding_it():
    touched = dense(GRASP, 2, gripper_contacts=[[0.0], [1.0]])

    assert touched.tolist() == pytest.approx([0.0, 3 / 16])


@pytest.mark.parametrize("task_id", IDS)
@pytest.mark.parametrize("name", REWARDS)
def test_reward_is_1_at_success_wherever_the_gripper_is(task_id, name):
    done = moments(task_id, 3, **DONE[task_id], gripper_position=[FAR, HOME[:3], (0.5, 0.0, 0.1)])

    assert TASKS[task_id].success(done).all()
    assert REWARDS[name](TASKS[task_id], done).tolist() == [1.0] * 3


@pytest.mark.parametrize("task_id", IDS)
def test_rewards_of_random_motions(motions_of, task_id):
    task, columns = TASKS[task_id], motions_of(task_id).columns
    success = task.success(columns)
    sparse, shaped = (REWARDS[name](task, columns) for name in ("sparse", "dense"))

    assert sparse.dtype == shaped.dtype == np.float64
    assert np.array_equal(sparse, success.astype(float))
    assert (shaped[success] == 1.0).all()
    assert ((shaped[~success] >= 0.0) & (shaped[~success] <= 0.5)).all()
    assert len(np.unique(shaped)) > 20


def hold(env):
    """Put the mug between the fingers above the table, its handle away from them."""
    position = env.data.site("gripper_center").xpos
    env.data.joint("mug").qpos[:] = [*position, math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5)]
    env.data.joint("mug").qpos[2] -= 0.05
    for finger in (1, 2):
        env.data.joint(f"robot:panda0_finger_joint{finger}").qpos[0] = 0.0358


WAYS = {
    GRASP: hold,
    FAUCET: lambda env: env.data.joint("hot_tap").qpos.fill(0.5),
    DRAWER: lambda env: env.data.joint("drawer").qpos.fill(0.12),
    PUSH: lambda env: env.data.joint("mug").qpos.__setitem__(1, 0.06),
}


@pytest.mark.parametrize("task_id", IDS)
@pytest.mark.parametrize("reward", [None, *REWARDS])
def test_env_gives_1_exactly_where_the_info_says_success(task_id, reward):
    env = gym.make(task_id, **({} if reward is None else {"reward": reward})).unwrapped
    env.reset()
    action_map = load_scene(TASKS[task_id]).action_map
    action = action_map.actions(np.array(HOME), finger_target=np.array(FINGER_SQUEEZE))
    before = [env.step(action) for _ in range(3)]
    env.reset()
    WAYS[task_id](env)
    mujoco.mj_forward(env.model, env.data)
    after = [env.step(action) for _ in range(10)]

    assert {step[4]["is_success"] for step in before} == {False}
    assert {step[4]["is_success"] for step in after} == {True}
    assert {step[1] for step in after} == {1.0}
    assert all(type(step[1]) is float for step in before + after)
    if reward == "dense":
        assert all(0.0 < step[1] <= 0.5 for step in before)
    else:
        assert {step[1] for step in before} == {0.0}


def test_unknown_reward_names_the_known_ones():
    with pytest.raises(LQDError, match=r"^expected a reward of sparse, dense, got 'shaped'$"):
        get_reward("shaped")
    with pytest.raises(LQDError, match=r"^expected a reward of sparse, dense, got 'shaped'$"):
        ManipulationEnv(reward="shaped")
    with pytest.raises(LQDError, match=r"^expected a reward of sparse, dense, got \['a'\]$"):
        get_reward(["a"])
