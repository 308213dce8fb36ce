"""Registering tasks as Gymnasium environments."""

import re

import gymnasium as gym

from lqd_envs.env import MAX_EPISODE_STEPS
from lqd_envs.errors import LQDError
from lqd_envs.tasks.registry import DuplicateTaskError, add_task, require_free
from lqd_envs.tasks.task import Task

_ENTRY_POINT = "lqd_envs.env:ManipulationEnv"
_VECTOR_ENTRY_POINT = "lqd_envs.vector_env:ManipulationVectorEnv"
_ID = re.compile(r"[\w-]+/[\w.-]+-v\d+")


def register_task(task: Task) -> None:
    """Make a task known by its id, to `lqd_envs` and to Gymnasium.

    After it, `lqd_envs.rollout(task.id, ...)`, `gymnasium.make(task.id)` and
    `gymnasium.make_vec(task.id)` work. Registering the same task again does nothing, and after an
    error neither of the two knows the task.

    Args:
        task: The task; its id has the form `Namespace/Name-v0`.

    Raises:
        DuplicateTaskError: Another task has this id, or Gymnasium has it for something else.
        LQDError: The id has another form, or Gymnasium refuses it.
    """
    _require_well_formed(task.id)
    require_free(task)
    spec = gym.registry.get(task.id)
    if spec is None:
        _register(task)
    elif (spec.entry_point, spec.kwargs.get("task")) != (_ENTRY_POINT, task.id):
        raise DuplicateTaskError(
            f"expected an id that is still free, got {task.id!r}, which Gymnasium has for "
            f"{spec.entry_point}: give yours a name or version of its own"
        )
    add_task(task)


def _require_well_formed(task_id: object) -> None:
    if not isinstance(task_id, str) or not _ID.fullmatch(task_id):
        raise LQDError(
            f"expected the id of a task in the form Namespace/Name-v0, got {task_id!r}: name it so"
        )


def _register(task: Task) -> None:
    try:
        gym.register(
            id=task.id,
            entry_point=_ENTRY_POINT,
            vector_entry_point=_VECTOR_ENTRY_POINT,
            kwargs={"task": task.id},
            max_episode_steps=MAX_EPISODE_STEPS,
        )
    except gym.error.Error as error:
        raise LQDError(
            f"expected an id that Gymnasium takes, got {task.id!r} ({error}): give the task a name "
            "of its own"
        ) from error
