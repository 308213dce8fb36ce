import gymnasium as gym
import pytest

from lqd_envs import TASKS, LQDError, UnknownTaskError, get_task, register_envs
from lqd_envs.env import MAX_EPISODE_STEPS


@pytest.mark.parametrize("task_id", TASKS)
def test_task_is_found_by_its_id(task_id):
    assert get_task(task_id) is TASKS[task_id]
    assert get_task(task_id).id == task_id


def test_faucet_is_registered():
    assert "LQD/Faucet-v0" in TASKS


def test_registry_cannot_be_written(faucet):
    with pytest.raises(TypeError, match="does not support item assignment"):
        TASKS["LQD/Kettle-v0"] = faucet


@pytest.mark.parametrize("task_id", ["LQD/Kettle-v0", "Faucet-v0", "faucet", ""])
def test_unknown_task_names_the_known_ones(task_id):
    with pytest.raises(UnknownTaskError) as caught:
        get_task(task_id)

    assert str(caught.value) == (
        f"expected the id of a task, got {task_id!r}: known tasks are {', '.join(TASKS)}"
    )
    assert isinstance(caught.value, LQDError)
    assert isinstance(caught.value, KeyError)


@pytest.mark.parametrize("task_id", TASKS)
def test_every_task_is_a_gymnasium_env(task_id):
    spec = gym.spec(task_id)

    assert spec.max_episode_steps == MAX_EPISODE_STEPS == 150
    assert spec.kwargs == {"task": task_id}


def test_registering_again_changes_nothing():
    before = dict(gym.registry)

    register_envs()

    assert dict(gym.registry) == before
