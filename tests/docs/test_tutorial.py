"""The tutorial's code is that of its example, and both run."""

# Before mujoco, which chooses its OpenGL backend once and for all.
import lqd_envs

# isort: split
import importlib.util
import math
import re
import subprocess
import sys
from pathlib import Path

import gymnasium as gym
import mujoco
import numpy as np
import pytest
from gymnasium.envs.mujoco.utils import check_mujoco_reset_state
from gymnasium.utils.env_checker import check_env

from lqd_envs.scene import load_scene
from lqd_envs.scenes.panda import FINGER_OPEN, HOME
from lqd_envs.tasks import registry

ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "examples" / "light_switch.py"
TUTORIAL = ROOT / "docs" / "tutorials" / "own-task.md"
ID = "Home/LightSwitch-v0"
RANDOM_SOLUTIONS = 2000

BLOCKS = re.findall(
    r"^```python\n(.*?)^```$", TUTORIAL.read_text("utf-8"), re.DOTALL | re.MULTILINE
)
LITERAL = [block for block in BLOCKS if block in EXAMPLE.read_text("utf-8")]
RUN = [block for block in BLOCKS if block not in LITERAL]


@pytest.fixture(scope="module")
def example():
    """The example, imported as the module that the tutorial calls it."""
    spec = importlib.util.spec_from_file_location("light_switch", EXAMPLE)
    module = importlib.util.module_from_spec(spec)
    sys.modules["light_switch"] = module
    spec.loader.exec_module(module)
    yield module
    # Other tests go through all tasks; nothing public forgets one.
    del sys.modules["light_switch"], gym.registry[ID], registry._TASKS[ID]


@pytest.fixture(scope="module")
def trajectories(example):
    solutions = lqd_envs.SolutionSpace().sample(RANDOM_SOLUTIONS, rng=np.random.default_rng(0))
    return lqd_envs.rollout(example.LIGHT_SWITCH, solutions)


def test_tutorial_shows_the_whole_example():
    rest = EXAMPLE.read_text("utf-8")
    for block in LITERAL:
        assert rest.count(block) == 1
        rest = rest.replace(block, "")

    # What it does not show: the module's docstring.
    lines = [line for line in rest.splitlines() if line.strip()]
    assert len(lines) == 1
    assert lines[0].startswith('"""')


def test_some_blocks_are_run():
    assert len(LITERAL) == 12
    assert len(RUN) == 3


@pytest.mark.usefixtures("example")
def test_every_other_block_runs_in_order():
    namespace = {}
    for block in RUN:
        exec(compile(block, str(TUTORIAL), "exec"), namespace)

    assert namespace["trajectories"].valid.any()


def test_links_of_the_tutorial_lead_somewhere():
    for target in re.findall(r"\]\(([^)#:]+)\)", TUTORIAL.read_text("utf-8")):
        assert (TUTORIAL.parent / target).exists()
    for path in re.findall(r"`(lqd_envs/[\w/]+\.py)`", TUTORIAL.read_text("utf-8")):
        assert (ROOT / path).exists()


def test_task_is_registered_once_under_its_id(example):
    assert lqd_envs.get_task(ID) is example.LIGHT_SWITCH
    assert EXAMPLE.read_text("utf-8").count("register_task(") == 1


@pytest.mark.usefixtures("example")
def test_task_follows_gymnasium_s_api_without_a_warning():
    check_env(gym.make(ID).unwrapped, skip_render_check=True)
    check_mujoco_reset_state(gym.make(ID))


def test_task_has_the_difficulty_that_the_tutorial_says(trajectories):
    success = trajectories.success()

    assert trajectories.valid[:200].sum() > 20
    assert 0.001 <= success.mean() <= 0.05
    assert np.abs(success.mean() - 0.004) < 0.003
    assert 0.4 < trajectories.valid.mean() < 0.6


def test_success_is_honest_and_the_env_agrees(trajectories):
    i = int(np.flatnonzero(trajectories.success())[0])
    env = gym.make(ID, reward="dense").unwrapped
    _, info = env.reset(options={"arm": trajectories.plan.starts[i]})
    assert not info["is_success"]
    rewards = []
    touched = False
    for action in trajectories.plan.actions[i]:
        _, reward, _, _, info = env.step(action)
        rewards.append(reward)
        touched |= info["gripper_contacts"]["lever"]

    assert touched
    assert info["is_success"]
    assert rewards[-1] == 1.0
    assert rewards[0] < 0.5
    assert {key: info[key] for key in lqd_envs.Info.__annotations__} == trajectories.infos(i)[-1]


def test_stops_are_hard_and_the_ground_truth_is_within_its_grid(trajectories):
    angles = trajectories.columns.joint_positions[trajectories.valid, :, 0]
    cells = trajectories.task.ground_truth.cells(trajectories.ground_truth()[trajectories.valid])

    assert -0.05 < angles.min() < angles.max() < 1.05
    assert (cells >= 0).all()
    assert len(set(cells.tolist())) > 3


def test_friction_holds_the_lever_where_it_is_left(example):
    scene = load_scene(example.LIGHT_SWITCH)
    data = mujoco.MjData(scene.model)
    for angle in 0.0, 0.5, 0.9:
        mujoco.mj_resetData(scene.model, data)
        data.qpos[:] = scene.start_qpos(HOME)
        data.ctrl[:] = [*HOME, FINGER_OPEN, FINGER_OPEN]
        data.joint("lever").qpos[0] = angle
        mujoco.mj_step(scene.model, data, nstep=round(1.0 / scene.model.opt.timestep))

        assert data.joint("lever").qpos[0] == pytest.approx(angle, abs=2e-3)


def test_dense_reward_grows_with_the_angle(example, trajectories):
    angle = trajectories.columns.joint_positions[trajectories.valid, -1, 0]
    nearness = example.nearness_to_on(trajectories.columns)[trajectories.valid]

    assert ((nearness >= 0.0) & (nearness <= 1.0)).all()
    assert nearness[angle > 0.3].min() > np.median(nearness)


def test_module_named_before_the_colon_is_imported():
    code = (
        "import gymnasium as gym; "
        f"env = gym.make('light_switch:{ID}'); print(env.reset()[1]['joint_positions'])"
    )
    result = subprocess.run(
        [sys.executable, "-W", "error", "-c", code],
        cwd=EXAMPLE.parent,
        capture_output=True,
        text=True,
        check=True,
    )

    assert math.isclose(float(re.findall(r"[\d.]+", result.stdout)[0]), 0.0, abs_tol=1e-9)
