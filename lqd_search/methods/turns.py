"""Whose turn it is to ask or to tell, and how many evaluations are left."""

import numpy as np
from numpy.typing import NDArray

from lqd_search.methods.method import MethodError


class Turns:
    """The turns of a method that spends a fixed number of evaluations, in generations.

    `size`, `ask`, `asked` and `tell` follow one another; what is out of turn is an error.

    Args:
        evaluations: Number of evaluations to spend, exactly.
        batch_size: Number of solutions in a generation; the last one may be smaller.

    Attributes:
        total: As given, the evaluations.
        batch_size: As given.
        evaluations: Number of evaluations told so far.
    """

    def __init__(self, evaluations: int, batch_size: int) -> None:
        self.total = evaluations
        self.batch_size = batch_size
        self.evaluations = 0
        self._asked: NDArray[np.float64] | None = None

    @property
    def done(self) -> bool:
        """Whether all evaluations are spent."""
        return self.evaluations == self.total

    def size(self) -> int:
        """Return the size of the next generation: the batch size, or what is left.

        Raises:
            MethodError: The generation before has not been told yet, or all is done.
        """
        if self._asked is not None or self.done:
            why = (
                "all evaluations are spent; begin another search"
                if self.done
                else "the last ones were not told yet; tell what they came to"
            )
            raise MethodError(f"Expected no further call of ask, since {why}.")
        return min(self.batch_size, self.total - self.evaluations)

    def ask(self, solutions: NDArray[np.float64]) -> NDArray[np.float64]:
        """Note the solutions that are asked for now, and return a copy for whoever evaluates them.

        Args:
            solutions: (n, dim) float64, as many as `size` said.
        """
        self._asked = solutions
        return solutions.copy()

    def asked(self) -> NDArray[np.float64]:
        """Return the (n, dim) solutions whose values are due.

        Raises:
            MethodError: Nothing was asked for.
        """
        if self._asked is None:
            raise MethodError("Expected a call of ask before tell; ask, evaluate, then tell.")
        return self._asked

    def tell(self) -> None:
        """Note that the values of these solutions were told."""
        self.evaluations += len(self.asked())
        self._asked = None
