"""Trying motions of an archive in an instance until one solves it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from lqd_envs import LQDError, Task, rollout
from lqd_envs.instances import Instance
from lqd_search.adaptation.archive_view import ArchiveView
from lqd_search.adaptation.selectors import Selector


class AdaptationError(LQDError):
    """An archive from which nothing can be tried."""


@dataclass(frozen=True, eq=False)
class Attempts:
    """Motions that were tried in an instance, in the order of a selector.

    Attributes:
        candidates: How many motions of the archive the inferred condition approves.
        rows: (n,) which elites of the archive were tried, the first one first.
        solved: (n,) bool: whether they solve the instance.
    """

    candidates: int
    rows: NDArray[np.intp]
    solved: NDArray[np.bool_]

    @property
    def solving(self) -> NDArray[np.intp]:
        """The elites that solve the instance, in the order in which they were tried."""
        return self.rows[self.solved]

    @property
    def tries(self) -> int | None:
        """How many tries it took until one solved the instance; None: none does."""
        return int(np.argmax(self.solved)) + 1 if self.solved.any() else None


def try_motions(
    view: ArchiveView,
    *,
    task: Task,
    instance: Instance,
    select: Selector,
    limit: int,
    threads: int = 0,
) -> Attempts:
    """Simulate the motions of an archive in an instance, in the order of a selector.

    Only those are tried that the inferred condition approves: a robot has no expert. Whether one
    solves the instance is what the simulation says.

    Args:
        view: What may be seen of the archive.
        task: The task that the archive was made for.
        instance: An instance of it.
        select: In which order to try.
        limit: Most motions to try.
        threads: Threads to simulate on; 0: one for each CPU.

    Raises:
        AdaptationError: The condition that steered the search approves no motion of the archive.
        InstanceError: It is not an instance of this task.
    """
    approved = np.flatnonzero(view.success)
    if not len(approved):
        raise AdaptationError(
            f"Expected a success in the archive, but none of its {len(view)} elites is one by the "
            "condition that steered it; search longer."
        )
    rows = approved[select(view.rows(approved), limit)]
    solved = solving(view.solution[rows], task=task, instance=instance, threads=threads)
    return Attempts(candidates=len(approved), rows=rows, solved=solved)


def solving(
    solutions: NDArray[np.float64], *, task: Task, instance: Instance, threads: int = 0
) -> NDArray[np.bool_]:
    """Return (N,) bool: which solutions, simulated in the instance, solve it.

    Args:
        solutions: (N, 9).
        task: The task.
        instance: An instance of it.
        threads: Threads to simulate on; 0: one for each CPU.
    """
    return rollout(instance.apply(task), solutions, threads=threads).success()
