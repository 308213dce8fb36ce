import json
import sys
from dataclasses import replace
from pathlib import Path

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode, SyncVectorEnv
from gymnasium.wrappers import TimeLimit
from gymnasium.wrappers.vector import RecordEpisodeStatistics

from lqd_envs import (
    PAPER_TASKS,
    LQDError,
    ManipulationEnv,
    RenderingError,
    ResetError,
    SolutionSpace,
    UnknownTaskError,
    get_task,
    rollout,
)
from lqd_envs.scene import load_scene
from lqd_envs.scenes.panda import HOME
from lqd_envs.vector_env import ManipulationVectorEnv

ID = "LQD/Faucet-v0"
MODES = list(AutoresetMode)
OVERLAPPING = (0.0, 0.6, 0.0, -2.2, 0.0, 0.33, 0.0)
ALTERNATIVE = (0.2, -0.5, 0.1, -2.0, 0.3, 1.0, -0.4)
COLUMNS = (
    "object_position",
    "object_orientation",
    "object_table_contact",
    "robot_table_contact",
    "gripper_position",
    "gripper_orientation",
)


@pytest.fixture
def envs():
    envs = ManipulationVectorEnv(3)
    yield envs
    envs.close()


@pytest.fixture(scope="module", params=PAPER_TASKS, ids=lambda task: task.name)
def motions(request):
    """Five valid motions of a task, of those that touch its object longest."""
    solutions = SolutionSpace().sample(400, rng=np.random.default_rng(5))
    trajectories = rollout(request.param, solutions)
    touching = trajectories.columns.gripper_contacts.any(axis=2).sum(axis=1) * trajectories.valid
    rows = np.argsort(-touching, kind="stable")[:5]
    assert (touching[rows[:3]] > 0).all()
    return trajectories, rows


def singles(task, n, *, mode=AutoresetMode.NEXT_STEP, limit=10**6):
    """N single envs in Gymnasium's own loop."""

    def make():
        return TimeLimit(ManipulationEnv(task.id, reward="dense"), limit)

    return SyncVectorEnv([make] * n, autoreset_mode=mode)


def random_actions(n, *, steps, seed=0):
    return np.random.default_rng(seed).uniform(-1.2, 1.2, (steps, n, 8)).astype(np.float32)


def of_env(infos, i):
    """What columns of any kind say about one env."""
    values = {}
    for key, value in infos.items():
        if not key.startswith("_") and infos[f"_{key}"][i]:
            row = of_env(value, i) if isinstance(value, dict) else np.asarray(value[i]).tolist()
            values[key] = row
    return values


def bits(result):
    """Every bit of what `reset` or `step` returned."""
    *arrays, infos = result
    n = len(arrays[0])
    assert all(isinstance(array, np.ndarray) for array in arrays)
    return (
        [(array.dtype, array.shape, array.tobytes()) for array in arrays],
        [json.dumps(of_env(infos, i), sort_keys=True) for i in range(n)],
    )


def reset_both(ours, theirs, *, mask, arm):
    """Reset both alike; Gymnasium's takes its mask out of the options, so each gets its own."""
    mine = ours.reset(options={"reset_mask": mask.copy(), "arm": arm})
    assert bits(mine) == bits(theirs.reset(options={"reset_mask": mask.copy(), "arm": arm}))


def assert_agree(ours, theirs, actions):
    for action in actions:
        assert bits(ours.step(action)) == bits(theirs.step(action))


@pytest.mark.parametrize("threads", [1, 2])
def test_motion_has_the_bits_of_single_envs_and_of_the_batch(motions, threads):
    trajectories, rows = motions
    task, starts = trajectories.task, trajectories.plan.starts[rows]
    ours = ManipulationVectorEnv(
        5, task.id, reward="dense", max_episode_steps=None, threads=threads
    )
    theirs = [ManipulationEnv(task.id, reward="dense") for _ in rows]

    moments = [ours.reset(options={"arm": starts})]
    expected = [[env.reset(options={"arm": arm}) for env, arm in zip(theirs, starts, strict=True)]]
    for action in trajectories.plan.actions[rows].swapaxes(0, 1):
        moments.append(ours.step(action))
        expected.append([env.step(row) for env, row in zip(theirs, action, strict=True)])

    for k, (mine, singly) in enumerate(zip(moments, expected, strict=True)):
        assert mine[0].tobytes() == np.stack([one[0] for one in singly]).tobytes()
        for i, row in enumerate(rows):
            info = of_env(mine[-1], i)
            assert json.dumps(info) == json.dumps(singly[i][-1])
            del info["is_success"], info["discarded"]
            assert json.dumps(info) == json.dumps(trajectories.infos(row)[k])
    rewards = np.array([mine[1] for mine in moments[1:]])
    assert rewards.tobytes() == np.array([[o[1] for o in s] for s in expected[1:]]).tobytes()
    assert 0.0 < rewards.min() < rewards.max()
    success = moments[-1][-1]["is_success"]
    assert success.tolist() == trajectories.success()[rows].tolist()


@pytest.mark.parametrize("threads", [1, 2])
def test_columns_have_the_bits_of_the_batch_s_columns(motions, threads):
    trajectories, rows = motions
    envs = ManipulationVectorEnv(5, trajectories.task.id, threads=threads)
    infos = [envs.reset(options={"arm": trajectories.plan.starts[rows]})[1]]
    infos += [envs.step(trajectories.plan.actions[rows, k])[4] for k in range(75)]

    for key in COLUMNS:
        expected = getattr(trajectories.columns, key)[rows]
        column = np.stack([info[key] for info in infos], axis=1)
        assert (column.dtype, column.tobytes()) == (expected.dtype, expected.tobytes())


@pytest.mark.parametrize("mode", MODES)
def test_agrees_with_single_envs_through_autoresets_and_partial_resets(motions, mode):
    trajectories, rows = motions
    task, plan = trajectories.task, trajectories.plan
    ours = ManipulationVectorEnv(
        5, task.id, reward="dense", max_episode_steps=60, autoreset_mode=mode, threads=2
    )
    theirs = singles(task, 5, mode=mode, limit=60)
    assert bits(ours.reset()) == bits(theirs.reset())
    for i, row in enumerate(rows):
        reset_both(ours, theirs, mask=np.arange(5) == i, arm=plan.starts[row])

    actions = plan.actions[rows].swapaxes(0, 1)
    assert_agree(ours, theirs, actions[:25])
    reset_both(ours, theirs, mask=np.array([True, False, False, True, False]), arm=ALTERNATIVE)
    # In contact, whatever a policy may do.
    ended = np.zeros(5, dtype=bool)
    for action in np.concatenate([actions[25:50], random_actions(5, steps=45)]):
        mine = ours.step(action)
        assert bits(mine) == bits(theirs.step(action))
        ended |= mine[3]
        if mode is AutoresetMode.DISABLED and mine[3].any():
            reset_both(ours, theirs, mask=mine[3], arm=HOME)
    assert ended.all()


@pytest.mark.parametrize("mode", MODES)
def test_agrees_with_gymnasium_s_sync_vector_env(mode):
    ours = gym.make_vec(ID, num_envs=3, autoreset_mode=mode, max_episode_steps=15)
    theirs = gym.make_vec(
        ID,
        num_envs=3,
        vectorization_mode="sync",
        vector_kwargs={"autoreset_mode": mode},
        max_episode_steps=15,
    )
    for space in ("observation_space", "action_space"):
        assert getattr(ours, space) == getattr(theirs, space)
        assert getattr(ours, f"single_{space}") == getattr(theirs, f"single_{space}")
    assert ours.metadata["autoreset_mode"] is theirs.metadata["autoreset_mode"]
    assert bits(ours.reset(seed=3)) == bits(theirs.reset(seed=3))

    ends = 0
    for k, action in enumerate(random_actions(3, steps=40)):
        mine, reference = ours.step(action), theirs.step(action)
        assert bits(mine) == bits(reference)
        assert set(mine[4]) == set(reference[4])
        ends += mine[3].sum()
        if k == 4:
            reset_both(ours, theirs, mask=np.array([False, True, False]), arm=HOME)
        if mode is AutoresetMode.DISABLED and mine[3].any():
            reset_both(ours, theirs, mask=mine[3], arm=HOME)
    assert ends >= 4


def test_is_what_make_vec_makes():
    envs = gym.make_vec(ID, num_envs=3)

    assert type(envs) is ManipulationVectorEnv
    assert envs.spec.id == ID
    assert (envs.num_envs, envs.spec.max_episode_steps) == (3, 150)
    assert envs.metadata["autoreset_mode"] is AutoresetMode.NEXT_STEP
    assert envs.metadata["render_fps"] == 50
    assert envs.observation_names == ManipulationEnv().observation_names
    envs.close()


@pytest.mark.parametrize("task", PAPER_TASKS, ids=lambda task: task.name)
def test_every_task_is_made_by_its_id(task):
    envs = gym.make_vec(task.id, num_envs=2, reward="dense", threads=1)
    envs.reset()

    assert (envs.step(np.zeros((2, 8)))[1] > 0.0).all()
    assert set(envs.reset()[1]["gripper_contacts"]) == {
        name for link in task.schema.links for name in (link, f"_{link}")
    }


def test_values_are_in_their_spaces_and_of_their_types(envs):
    observations, _ = envs.reset(seed=0)
    assert observations in envs.observation_space
    envs.action_space.seed(0)

    for _ in range(30):
        observations, rewards, terminations, truncations, infos = envs.step(
            envs.action_space.sample()
        )
        assert observations in envs.observation_space
        assert (rewards.dtype, rewards.shape) == (np.float64, (3,))
        assert (terminations.dtype, truncations.dtype) == (np.bool_, np.bool_)
    for key in ("object_position", "gripper_orientation"):
        assert (infos[key].dtype, infos[key].shape) == (np.float64, (3, 3))
    for key in ("is_success", "discarded", "object_table_contact", "robot_table_contact"):
        assert (infos[key].dtype, infos[key].shape) == (np.bool_, (3,))
    assert infos["joint_positions"]["hot_tap"].shape == (3,)
    assert infos["gripper_contacts"]["base"].dtype == np.bool_


def test_two_vector_envs_agree_whatever_their_threads():
    first, second = ManipulationVectorEnv(4, threads=1), ManipulationVectorEnv(4, threads=3)
    assert bits(first.reset(seed=1)) == bits(second.reset(seed=1))

    assert_agree(first, second, random_actions(4, steps=40))


def test_row_does_not_depend_on_the_others():
    many, one = ManipulationVectorEnv(4, reward="dense"), ManipulationVectorEnv(1, reward="dense")
    many.reset()
    one.reset()

    for action in random_actions(4, steps=30):
        mine, alone = many.step(action), one.step(action[2:3])
        assert mine[0][2].tobytes() == alone[0][0].tobytes()
        assert mine[1][2] == alone[1][0]
        assert of_env(mine[4], 2) == of_env(alone[4], 0)


def test_masks_say_whom_an_info_is_for(envs):
    _, infos = envs.reset()
    assert infos["_is_success"].tolist() == [True] * 3
    before = envs.step(random_actions(3, steps=1)[0])[0]
    mask = np.array([False, True, False])
    options = {"reset_mask": mask, "arm": [HOME, ALTERNATIVE, [np.nan] * 7]}

    observations, infos = envs.reset(options=options)

    assert options["reset_mask"] is mask
    assert observations[[0, 2]].tobytes() == before[[0, 2]].tobytes()
    assert observations[1, :7].tolist() == list(ALTERNATIVE)
    for key in (*COLUMNS, "is_success", "discarded", "gripper_contacts", "joint_positions"):
        assert infos[f"_{key}"].tolist() == [False, True, False]
    for key in ("gripper_contacts", "joint_positions"):
        for name in [name for name in infos[key] if not name.startswith("_")]:
            assert infos[key][f"_{name}"].tolist() == [False, True, False]
    assert not infos["gripper_position"][[0, 2]].any()
    assert infos["gripper_position"][1].any()
    assert not infos["object_table_contact"][[0, 2]].any()


def test_next_step_resets_and_ignores_the_action():
    envs = ManipulationVectorEnv(2, reward="dense", max_episode_steps=3)
    start = envs.reset()[0]
    for _ in range(3):
        truncations = envs.step(np.ones((2, 8)))[3]
    assert truncations.tolist() == [True, True]

    observations, rewards, _, truncations, infos = envs.step(np.full((2, 8), np.nan))

    assert observations.tobytes() == start.tobytes()
    assert rewards.tolist() == [0.0, 0.0]
    assert not truncations.any()
    assert infos["_is_success"].all()
    assert (envs.step(np.ones((2, 8)))[1] > 0.0).all()


def test_same_step_tells_how_the_episode_ended():
    envs = ManipulationVectorEnv(2, max_episode_steps=3, autoreset_mode="SameStep")
    whole = ManipulationVectorEnv(2)
    start = envs.reset()[0]
    whole.reset()
    envs.step(np.ones((2, 8)))
    envs.reset(options={"reset_mask": np.array([False, True])})
    assert "final_obs" not in envs.step(np.ones((2, 8)))[4]
    whole.step(np.ones((2, 8)))
    whole.step(np.ones((2, 8)))

    observations, _, _, truncations, infos = envs.step(np.ones((2, 8)))

    last, _, _, _, last_infos = whole.step(np.ones((2, 8)))
    assert truncations.tolist() == [True, False]
    assert observations[0].tobytes() == start[0].tobytes()
    assert infos["final_obs"][0].tobytes() == last[0].tobytes()
    assert infos["final_obs"][1] is None
    assert infos["_final_info"].tolist() == [True, False]
    assert of_env(infos["final_info"], 0) == of_env(last_infos, 0)
    assert of_env(infos["final_info"], 1) == {}


def test_disabled_autoreset_asks_for_a_reset():
    envs = ManipulationVectorEnv(3, max_episode_steps=4, autoreset_mode=AutoresetMode.DISABLED)
    envs.reset()
    envs.step(np.zeros((3, 8)))
    envs.reset(options={"reset_mask": np.array([False, True, False])})
    for _ in range(3):
        truncations = envs.step(np.zeros((3, 8)))[3]
    assert truncations.tolist() == [True, False, True]

    text = r"expected envs 0, 2 to be reset after the end .*autoreset is disabled: call envs\.reset"
    with pytest.raises(LQDError, match=text):
        envs.step(np.zeros((3, 8)))

    envs.reset(options={"reset_mask": truncations})
    assert envs.step(np.zeros((3, 8)))[3].tolist() == [False, True, False]


@pytest.mark.parametrize("limit", [None, -1])
def test_episode_without_a_limit_goes_on(limit):
    envs = gym.make_vec(ID, num_envs=1, max_episode_steps=limit)
    envs.reset()

    assert not any(envs.step(np.zeros((1, 8)))[3].any() for _ in range(160))


def test_episode_is_truncated_after_150_steps():
    envs = gym.make_vec(ID, num_envs=1)
    envs.reset()

    ends = [bool(envs.step(np.zeros((1, 8)))[3][0]) for _ in range(152)]

    assert ends == [False] * 149 + [True, False, False]


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("speed", [1e12, 1e6, 1e3])
def test_divergence_is_that_of_single_envs(mode, speed, faucet, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)  # where MuJoCo writes its log
    ours = ManipulationVectorEnv(3, reward="dense", autoreset_mode=mode)
    theirs = singles(faucet, 3, mode=mode, limit=150)
    ours.reset()
    theirs.reset()
    actions = random_actions(3, steps=8)
    assert_agree(ours, theirs, actions[:2])
    ours.batch.bind("qvel")[1] = speed
    theirs.envs[1].unwrapped.data.qvel[:] = speed

    mine = ours.step(actions[2])

    assert bits(mine) == bits(theirs.step(actions[2]))
    assert mine[3].tolist() == [False, True, False]
    assert mine[1][1] == 0.0
    ended = mine[4]["final_info"] if mode is AutoresetMode.SAME_STEP else mine[4]
    assert of_env(ended, 1)["is_success"] is False
    assert [of_env(ended, 1)["discarded"], mine[4]["discarded"][0]] == [True, False]
    if mode is AutoresetMode.DISABLED:
        reset_both(ours, theirs, mask=mine[3], arm=HOME)
    for action in actions[3:]:
        mine = ours.step(action)
        assert bits(mine) == bits(theirs.step(action))
        assert not mine[3].any()
        assert not mine[4]["discarded"].any()


def test_divergence_is_no_success(envs, monkeypatch, tmp_path):
    def always(columns):
        return np.ones(len(columns.object_position), dtype=bool)

    monkeypatch.chdir(tmp_path)  # where MuJoCo writes its log
    scene = load_scene(get_task(ID))
    monkeypatch.setattr(envs, "_scene", replace(scene, task=replace(scene.task, success=always)))
    assert envs.reset()[1]["is_success"].tolist() == [True] * 3
    envs.batch.bind("qvel")[1] = 1e12

    _, rewards, _, truncations, infos = envs.step(np.zeros((3, 8)))

    assert truncations.tolist() == [False, True, False]
    assert rewards.tolist() == [1.0, 0.0, 1.0]
    assert infos["is_success"].tolist() == [True, False, True]
    assert infos["discarded"].tolist() == [False, True, False]


def test_infos_and_observations_are_one_s_own(envs):
    kept = envs.reset()
    before = bits(kept)
    step = envs.step(np.ones((3, 8)))
    stepped = bits(step)
    for _ in range(10):
        envs.step(-np.ones((3, 8)))

    assert bits(kept) == before
    assert bits(step) == stepped


def test_seeds_draw_the_same_numbers(envs):
    envs.reset(seed=4)
    drawn = envs.np_random.random()

    envs.reset(seed=[4, 5, None])
    assert envs.np_random.random() == drawn
    envs.reset(seed=5)
    assert envs.np_random.random() != drawn
    with pytest.raises(ResetError, match=r"a list of 3 seeds, one for each env, got a list of 2"):
        envs.reset(seed=[1, 2])


def test_works_with_recorded_statistics():
    envs = RecordEpisodeStatistics(ManipulationVectorEnv(2, reward="dense", max_episode_steps=5))
    envs.reset()
    rewards = []
    for _ in range(5):
        _, reward, _, _, infos = envs.step(np.ones((2, 8)))
        rewards.append(reward)

    assert infos["_episode"].tolist() == [True, True]
    assert infos["episode"]["l"].tolist() == [5, 5]
    assert infos["episode"]["r"] == pytest.approx(np.sum(rewards, axis=0))
    envs.reset(options={"reset_mask": np.array([True, False])})
    envs.close()


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"leg": 1}, r"expected the options 'arm' and 'reset_mask' at most, got 'leg'$"),
        (5, r"expected options as a dictionary or None, got 5: write them as"),
        (
            np.ones(3, bool),
            r"options as a dictionary or None, got bool array of shape \(3,\): write",
        ),
        ({"arm": HOME[:6]}, r"7 finite joint positions in rad, or 3 rows of them, .*got \(0\.0"),
        (
            {"arm": np.zeros((2, 7))},
            r"3 rows of them, one for each env, got float64 array of shape \(2, 7",
        ),
        ({"arm": None}, r"one for each env, got None$"),
        ({"arm": "abc"}, r"one for each env, got 'abc'$"),
        (
            {"arm": [HOME, HOME, (*HOME[:6], np.nan)]},
            r"expected the option 'arm' to be finite joint positions .*nan\] for env 2$",
        ),
        (
            {"arm": [HOME, (2.9, *HOME[1:]), HOME]},
            r"arm joint 1 of env 1 within \[-2\.8973, 2\.8973\] rad, got 2\.9000$",
        ),
        (
            {"arm": [HOME, OVERLAPPING, OVERLAPPING]},
            r"inside an obstacle in envs 1, 2: start further away$",
        ),
        ({"reset_mask": [True, False, True]}, r"a NumPy array of 3 bools, got \[True, False, T"),
        ({"reset_mask": np.ones(3)}, r"array of 3 bools, got float64 array of shape \(3,\)$"),
        ({"reset_mask": np.ones(2, bool)}, r"array of 3 bools, got bool array of shape \(2,\)$"),
        ({"reset_mask": np.zeros(3, bool)}, r"pick one env at least, got False for every env"),
    ],
)
def test_wrong_options_are_refused(envs, options, text):
    envs.reset()
    with pytest.raises(ResetError, match=text):
        envs.reset(options=options)


def test_refused_options_leave_the_episodes_alone(envs):
    envs.reset()
    undisturbed = bits(envs.step(np.ones((3, 8))))
    envs.reset()
    for options in ({"leg": 1}, {"arm": [0.0]}, {"reset_mask": np.zeros(3, bool)}):
        with pytest.raises(ResetError):
            envs.reset(options=options)
    with pytest.raises(LQDError):
        envs.step(np.full((3, 8), np.nan))

    assert bits(envs.step(np.ones((3, 8)))) == undisturbed


def test_overlapping_start_must_be_reset_again(envs):
    envs.reset()
    mask = np.array([False, True, False])
    with pytest.raises(ResetError, match=r"inside the table, .* an obstacle in env 1: start"):
        envs.reset(options={"arm": OVERLAPPING, "reset_mask": mask})
    with pytest.raises(LQDError, match=r"expected reset\(\) before step\(\), but env 1 did not"):
        envs.step(np.zeros((3, 8)))

    envs.reset(options={"reset_mask": mask})

    assert not envs.step(np.zeros((3, 8)))[3].any()


def test_first_reset_is_for_all(envs):
    with pytest.raises(ResetError, match=r"not started yet, but envs 0, 2 would be left out"):
        envs.reset(options={"reset_mask": np.array([False, True, False])})


def test_actions_that_are_no_numbers_are_named_by_their_type(envs):
    envs.reset()

    with pytest.raises(LQDError, match=r"one row for each env, got <U1 array of shape \(3, 8\)$"):
        envs.step(np.full((3, 8), "a"))


@pytest.mark.parametrize("actions", [np.zeros(8), np.zeros((2, 8)), np.zeros((3, 7)), None, "abc"])
def test_actions_of_a_wrong_shape_are_refused(envs, actions):
    envs.reset()

    with pytest.raises(LQDError, match=r"expected actions of shape \(3, 8\), one row for each env"):
        envs.step(actions)


def test_actions_that_are_not_finite_are_refused(envs):
    envs.reset()
    actions = np.zeros((3, 8))
    actions[1, 2] = np.inf

    with pytest.raises(LQDError, match=r"expected actions of finite numbers .*inf.* for env 1$"):
        envs.step(actions)


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ({"num_envs": 0}, r"expected num_envs to be a whole number of at least 1, got 0$"),
        ({"num_envs": 1.5}, r"expected num_envs to be a whole number of at least 1, got 1\.5$"),
        ({"threads": -1}, r"expected threads to be a whole number of at least 0, got -1$"),
        ({"threads": 1.5}, r"expected threads to be a whole number of at least 0, got 1\.5$"),
        ({"threads": "2"}, r"expected threads to be a whole number of at least 0, got '2'$"),
        ({"threads": True}, r"expected threads to be a whole number of at least 0, got True$"),
        ({"max_episode_steps": 0}, r"at least 1, or None or -1 for no limit, got 0$"),
        ({"autoreset_mode": "Never"}, r"one of NextStep, SameStep, Disabled, got 'Never'$"),
        ({"autoreset_mode": ["Never"]}, r"SameStep, Disabled, got \['Never'\]$"),
        ({"render_mode": "human"}, r"to be one of \['rgb_array'\] or None, got 'human'$"),
        ({"reward": "none"}, r"expected a reward of sparse, dense, got 'none'$"),
        ({"width": 0}, r"expected pictures of 1 x 1 to 1920 x 1440 pixels, got 0 x 480$"),
        ({"width": 640.5}, r"width and height to be whole numbers of pixels, got 640\.5 and 480$"),
    ],
)
def test_wrong_arguments_are_refused(arguments, text):
    with pytest.raises(LQDError, match=text):
        ManipulationVectorEnv(**{"num_envs": 2, **arguments})


def test_unknown_task_names_the_known_ones():
    with pytest.raises(UnknownTaskError, match=r"got 'LQD/Kettle-v0': known tasks are LQD/"):
        ManipulationVectorEnv(2, "LQD/Kettle-v0")


def test_first_step_needs_a_reset():
    envs = ManipulationVectorEnv(7, render_mode="rgb_array")

    with pytest.raises(LQDError, match=r"before step\(\), but envs 0, 1, 2, 3, 4 and 2 more did"):
        envs.step(np.zeros((7, 8)))
    with pytest.raises(LQDError, match=r"expected reset\(\) before render\(\)"):
        envs.render()


def test_close_twice(envs):
    envs.reset()
    envs.close()
    envs.close()


def test_closed_envs_cannot_be_used():
    envs = ManipulationVectorEnv(2, render_mode="rgb_array")
    envs.reset()
    envs.close()

    for use in (envs.reset, lambda: envs.step(np.zeros((2, 8))), envs.render, lambda: envs.batch):
        with pytest.raises(
            LQDError, match=r"^expected open envs, got closed ones: make them anew$"
        ):
            use()


@pytest.mark.skipif(sys.platform != "linux", reason="counts threads as Linux lists them")
def test_close_ends_the_threads():
    def threads():
        return len(list(Path("/proc/self/task").iterdir()))

    before = threads()
    envs = ManipulationVectorEnv(8, threads=4)
    envs.reset()
    envs.step(np.zeros((8, 8)))
    assert threads() > before

    envs.close()

    assert threads() == before


def test_pictures_are_those_of_single_envs():
    envs = ManipulationVectorEnv(2, render_mode="rgb_array", width=160, height=120)
    single = ManipulationEnv(render_mode="rgb_array", width=160, height=120)
    envs.reset()
    single.reset()
    actions = random_actions(2, steps=12)
    for action in actions[:6]:
        envs.step(action)
        single.step(action[1])
    try:
        expected = single.render()
    except RenderingError as error:
        pytest.skip(str(error))

    pictures = envs.render()

    assert [(picture.shape, picture.dtype) for picture in pictures] == [
        ((120, 160, 3), "uint8")
    ] * 2
    assert (pictures[0] != pictures[1]).any()
    assert np.array_equal(pictures[1], expected)
    # Drawing leaves the simulations alone.
    for action in actions[6:]:
        assert envs.step(action)[0][1].tobytes() == single.step(action[1])[0].tobytes()
    envs.close()
    single.close()


def test_no_picture_without_a_render_mode(envs):
    assert envs.render() is None
