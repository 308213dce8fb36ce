"""A predicate: a condition on a motion beyond the expert's success."""

from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from lqd_envs.perception import Columns
from lqd_envs.tasks.task import Task


@runtime_checkable
class Predicate(Protocol):
    """A condition on what is perceived of a motion: a frozen dataclass of plain values.

    One of a user's own is drawn for no task, and `Instance.from_json` does not know it.
    """

    @property
    def kind(self) -> str:
        """Name of its class in JSON."""

    def require_fits(self, task: Task) -> None:
        """Raise `InstanceError` where the condition says nothing about a task's object."""

    def holds(self, columns: Columns) -> NDArray[np.bool_]:
        """Return (N,) bool: does the last moment, given the first, meet the condition?

        Args:
            columns: (N, T, ...) perception.
        """
