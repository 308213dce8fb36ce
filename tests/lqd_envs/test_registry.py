from dataclasses import replace

import gymnasium as gym
import pytest

from lqd_envs import (
    PAPER_TASKS,
    TASKS,
    DuplicateTaskError,
    LQDError,
    UnknownTaskError,
    get_task,
    register_task,
)
from lqd_envs.env import MAX_EPISODE_STEPS
from lqd_envs.tasks import registry


@pytest.mark.parametrize("task_id", TASKS)
def test_task_is_found_by_its_id(task_id):
    assert get_task(task_id) is TASKS[task_id]
    assert get_task(task_id).id == task_id


def test_paper_s_four_tasks_are_registered_in_its_order():
    assert [task.id for task in PAPER_TASKS] == [
        "LQD/Grasp-v0",
        "LQD/Faucet-v0",
        "LQD/Drawer-v0",
        "LQD/Push-v0",
    ]
    assert all(TASKS[task.id] is task for task in PAPER_TASKS)


def test_gymnasium_and_the_task_table_know_the_same_ids():
    assert {task_id for task_id in gym.registry if task_id.startswith("LQD/")} == {
        task_id for task_id in TASKS if task_id.startswith("LQD/")
    }


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


@pytest.mark.parametrize("task_id", TASKS)
def test_registering_again_changes_nothing(task_id):
    before = dict(gym.registry), dict(TASKS)

    register_task(TASKS[task_id])

    assert (dict(gym.registry), dict(TASKS)) == before


def test_second_task_of_the_same_id_is_refused(faucet):
    before = dict(gym.registry), dict(TASKS)

    with pytest.raises(DuplicateTaskError) as caught:
        register_task(replace(faucet, instruction="Turn on the cold water"))

    assert str(caught.value) == (
        "expected an id that is still free, got 'LQD/Faucet-v0', which another task has: give "
        "yours a name or version of its own"
    )
    assert isinstance(caught.value, LQDError)
    assert isinstance(caught.value, ValueError)
    assert (dict(gym.registry), dict(TASKS)) == before


@pytest.fixture
def spare_id():
    """An id that is free, and is so again afterwards."""
    task_id = "Tests/Spare-v0"
    yield task_id
    gym.registry.pop(task_id, None)
    # The public view cannot be written.
    registry._TASKS.pop(task_id, None)


def test_task_of_one_s_own_is_found_by_its_id_everywhere(faucet, spare_id):
    mine = replace(faucet, id=spare_id, instruction="Turn on the water")

    register_task(mine)

    assert get_task(spare_id) is mine
    assert gym.make(spare_id).get_wrapper_attr("observation_names")
    assert gym.make_vec(spare_id, num_envs=2).num_envs == 2


@pytest.mark.parametrize(
    "task_id",
    ["Sink", "Home/Sink", "Sink-v0", "Home/Sink v0-v1", "Home/Sink-v", "a:Home/Sink-v0", "", 3],
)
def test_id_of_another_form_is_refused(faucet, task_id):
    before = dict(gym.registry), dict(TASKS)

    with pytest.raises(LQDError, match=r"in the form Namespace/Name-v0, got .*: name it so$"):
        register_task(replace(faucet, id=task_id))

    assert (dict(gym.registry), dict(TASKS)) == before


def test_id_that_gymnasium_has_for_something_else_is_refused(faucet, spare_id):
    gym.register(id=spare_id, entry_point="somewhere:Else")
    before = dict(gym.registry), dict(TASKS)

    with pytest.raises(DuplicateTaskError, match=r"'Tests/Spare-v0', which Gymnasium has for some"):
        register_task(replace(faucet, id=spare_id))

    assert (dict(gym.registry), dict(TASKS)) == before


def test_id_that_gymnasium_refuses_is_not_known_to_anybody(faucet, spare_id):
    unversioned = spare_id.removesuffix("-v0")
    gym.register(id=unversioned, entry_point="somewhere:Else")
    before = dict(gym.registry), dict(TASKS)
    try:
        with pytest.raises(
            LQDError, match=r"an id that Gymnasium takes, got 'Tests/Spare-v0' \(Can"
        ):
            register_task(replace(faucet, id=spare_id))

        assert (dict(gym.registry), dict(TASKS)) == before
    finally:
        del gym.registry[unversioned]
