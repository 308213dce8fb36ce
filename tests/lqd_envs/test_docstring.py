"""The class docstring is the environments' page of documentation."""

import inspect
import re

import gymnasium as gym
import numpy as np
import pytest

from lqd_envs import TASKS, ManipulationEnv
from lqd_envs.env import MAX_EPISODE_STEPS
from lqd_envs.reward import REWARDS
from lqd_envs.scene import load_scene
from lqd_envs.verdict import DEEPEST_CONTACT, FASTEST_OBJECT

PAGE = inspect.getdoc(ManipulationEnv)
HEADINGS = [
    "Description",
    "Action space",
    "Observation space",
    "Info",
    "Reward",
    "Start",
    "End",
    "Simulation",
    "Arguments",
    "Version history",
]
LQD_IDS = sorted(task_id for task_id in TASKS if task_id.startswith("LQD/"))


def section(heading):
    """The text under a heading."""
    return PAGE.partition(f"## {heading}\n")[2].partition("\n## ")[0]


def action_rows():
    """The action table: entry, what it is the target of, at -1, at +1, unit."""
    rows = re.findall(r"^\| (\d) \| (.+) \| (\S+) \| (\S+) \| (\w+) \|$", PAGE, re.MULTILINE)
    return [
        (int(entry), name, float(low), float(high), unit) for entry, name, low, high, unit in rows
    ]


def test_page_has_every_heading_in_order():
    assert re.findall(r"^## (.+)$", PAGE, re.MULTILINE) == HEADINGS
    assert all(section(heading).strip() for heading in HEADINGS)


@pytest.mark.parametrize("task_id", LQD_IDS)
def test_action_table_is_the_map_of_actions_to_controls(task_id):
    action_map = load_scene(TASKS[task_id]).action_map
    rows = action_rows()

    assert [row[0] for row in rows] == list(range(8))
    # To the digits that are printed.
    assert [row[2] for row in rows] == pytest.approx(action_map.low.tolist(), abs=1e-12)
    assert [row[3] for row in rows] == pytest.approx(action_map.high.tolist(), abs=1e-12)
    assert [row[4] for row in rows] == ["rad"] * 7 + ["m"]


@pytest.mark.parametrize("task_id", LQD_IDS)
def test_action_space_is_the_documented_one(task_id):
    env = ManipulationEnv(task_id)

    assert "`Box(-1, 1, (8,), float32)`" in section("Action space")
    assert env.action_space == gym.spaces.Box(-1.0, 1.0, (8,), np.float32)


def test_arguments_are_those_of_the_constructor():
    documented = re.findall(r"`(\w+)`(?=[,:])", section("Arguments"))

    assert documented == list(inspect.signature(ManipulationEnv).parameters)
    assert all(f'"{name}"' in section("Arguments") for name in REWARDS)
    assert all(f'`reward="{name}"`' in section("Reward") for name in REWARDS)


def test_limits_of_what_is_discarded_are_the_documented_ones():
    assert f"more than {1e3 * DEEPEST_CONTACT:g} mm" in section("Info")
    assert f"faster than {FASTEST_OBJECT:g} m/s" in section("Info")


def test_length_of_an_episode_is_the_documented_one():
    assert f"truncated after {MAX_EPISODE_STEPS} control steps" in section("End")
    assert "A control step lasts\n20 ms." in section("Action space")


@pytest.mark.parametrize("task_id", LQD_IDS)
def test_every_task_is_named_with_its_instruction(task_id):
    assert f"`{task_id}`" in section("Description")
    assert f'"{TASKS[task_id].instruction}"' in " ".join(section("Description").split())


def test_every_name_of_an_observation_has_a_unit_or_is_a_flag_or_a_quaternion():
    for task_id in LQD_IDS:
        for name in ManipulationEnv(task_id).observation_names:
            assert re.search(r"\((rad|m|rad/s)\)$| touches | quaternion [wxyz]$", name)


def test_version_history_ends_with_the_version_that_is_registered():
    versions = re.findall(r"\* v(\d+):", section("Version history"))

    assert {gym.spec(task_id).version for task_id in LQD_IDS} == {int(versions[-1])}
