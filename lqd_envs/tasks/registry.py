"""The tasks by their ids."""

from types import MappingProxyType

from lqd_envs.errors import LQDError
from lqd_envs.tasks.drawer import DRAWER
from lqd_envs.tasks.faucet import FAUCET
from lqd_envs.tasks.grasp import GRASP
from lqd_envs.tasks.push import PUSH
from lqd_envs.tasks.task import Task

PAPER_TASKS = (GRASP, FAUCET, DRAWER, PUSH)
"""The paper's four tasks, in its order."""

_TASKS: dict[str, Task] = {}
TASKS = MappingProxyType(_TASKS)
"""Every registered task, by id."""


class UnknownTaskError(LQDError, KeyError):
    """A task id that is not registered."""

    __str__ = Exception.__str__  # KeyError would show the sentence in quotes


class DuplicateTaskError(LQDError, ValueError):
    """A task whose id another task has already."""


def require_free(task: Task) -> None:
    """Raise `DuplicateTaskError` where another task has a task's id."""
    if _TASKS.get(task.id, task) is not task:
        raise DuplicateTaskError(
            f"expected an id that is still free, got {task.id!r}, which another task has: give "
            "yours a name or version of its own"
        )


def add_task(task: Task) -> None:
    """Add a task, so that it is found by its id.

    Args:
        task: The task; adding the same one again does nothing.

    Raises:
        DuplicateTaskError: Another task has this id.
    """
    require_free(task)
    _TASKS.setdefault(task.id, task)


def get_task(task_id: str) -> Task:
    """Return the task of an id.

    Args:
        task_id: An id such as `LQD/Faucet-v0`.

    Raises:
        UnknownTaskError: There is no task of that id; the message names those there are.
    """
    if not isinstance(task_id, str) or task_id not in TASKS:
        raise UnknownTaskError(
            f"expected the id of a task, got {task_id!r}: known tasks are {', '.join(TASKS)}"
        )
    return TASKS[task_id]
