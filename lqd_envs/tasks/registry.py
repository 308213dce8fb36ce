"""The tasks by their ids."""

from types import MappingProxyType

from lqd_envs.errors import LQDError
from lqd_envs.tasks.faucet import FAUCET
from lqd_envs.tasks.task import Task

TASKS = MappingProxyType({task.id: task for task in (FAUCET,)})
"""Every task, by id."""


class UnknownTaskError(LQDError, KeyError):
    """A task id that is not registered."""

    __str__ = Exception.__str__  # KeyError would show the sentence in quotes


def get_task(task_id: str) -> Task:
    """Return the task of an id.

    Args:
        task_id: An id such as `LQD/Faucet-v0`.

    Raises:
        UnknownTaskError: There is no task of that id; the message names those there are.
    """
    if task_id not in TASKS:
        raise UnknownTaskError(
            f"expected the id of a task, got {task_id!r}: known tasks are {', '.join(TASKS)}"
        )
    return TASKS[task_id]
