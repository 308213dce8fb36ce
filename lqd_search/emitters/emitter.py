"""What every emitter of the multi-BD search looks like, and what it is told."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from lqd_envs.errors import LQDError
from lqd_search.archives.multi_bd_archive import MultiBDArchive
from lqd_search.evaluation.values import Values


class EmitterError(LQDError):
    """An emitter, or a part of one, that cannot work as it is given."""


@dataclass(frozen=True, eq=False)
class Evaluated:
    """A batch of N solutions after its evaluation, and what the archive made of it.

    Attributes:
        solutions: (N, dim) float64.
        values: What they came to.
        objective: (N,) float64, the fitness that is the objective; NaN where undefined.
        status: (N,) int32, from `MultiBDArchive.add`: 2 where the solution holds a cell that was
            empty, else 1 where it took one over, else 0. 0 where it was not offered.
        value: (N,) float64, from `MultiBDArchive.add`; -inf where it was not offered.
        asked: Whether these are the solutions that the emitter was asked for last, in their order;
            otherwise somebody else made them, such as the first batch.
    """

    solutions: NDArray[np.float64]
    values: Values
    objective: NDArray[np.float64]
    status: NDArray[np.int32]
    value: NDArray[np.float64]
    asked: bool

    def __len__(self) -> int:
        return len(self.solutions)

    @property
    def found(self) -> NDArray[np.bool_]:
        """(N,) bool: which solutions are successes that got into a cell."""
        return self.values.success & (self.status > 0)

    def rows(self, rows: NDArray[np.intp]) -> "Evaluated":
        """Return the chosen solutions alone; refusals, which count whole batches, are left out."""
        return Evaluated(
            solutions=self.solutions[rows],
            values=self.values.rows(rows),
            objective=self.objective[rows],
            status=self.status[rows],
            value=self.value[rows],
            asked=self.asked,
        )


class Emitter(Protocol):
    """Makes new solutions out of what an archive holds.

    It is asked and told in turns, and told of every batch that the archive is offered. It can be
    copied and pickled between `tell` and `ask`.
    """

    def ask(
        self, n: int, *, archive: MultiBDArchive, rng: np.random.Generator
    ) -> NDArray[np.float64]:
        """Make new solutions.

        Args:
            n: How many, perhaps 0.
            archive: What was found so far; it has at least one elite, and its passive columns are
                not to be read.
            rng: Source of all randomness.

        Returns:
            (n, dim) float64, feasible.
        """

    def tell(self, batch: Evaluated, *, archive: MultiBDArchive) -> None:
        """Learn from a batch.

        The archive has taken it already, and that is not undone if this fails: the scheduler then
        refuses every further call.

        Args:
            batch: What was evaluated; its values have no passive columns.
            archive: The archive, after it.
        """
