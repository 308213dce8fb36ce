"""Random search, the floor that every other method is measured against."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray
from ribs.typing import FieldDesc

from lqd_search.evaluation.values import Values
from lqd_search.methods.method import MethodError
from lqd_search.methods.told_columns import ToldColumns, stack
from lqd_search.methods.turns import Turns
from lqd_search.solution_space import SolutionSpace


class RandomSearch:
    """Uniform solutions, every one of them independent of what the others came to.

    It implements `Method`. It puts out all valid solutions, so its memory grows with them.

    Args:
        space: Where solutions come from.
        fitness: Name of the fitness that is recorded as the objective.
        evaluations: Number of evaluations to spend, exactly.
        batch_size: Number of solutions asked for at once; the last ones may be fewer.
        rng: Source of randomness.
        passive_fields: Passive columns to put out, in pyribs' form.

    Raises:
        MethodError: There is no evaluation, a batch has no solution, or a passive field has a name
            that is taken.
    """

    def __init__(
        self,
        space: SolutionSpace,
        *,
        fitness: str,
        evaluations: int,
        batch_size: int,
        rng: np.random.Generator,
        passive_fields: FieldDesc | None = None,
    ) -> None:
        if evaluations < 1 or batch_size < 1:
            raise MethodError(
                "Expected at least 1 evaluation and a batch size of at least 1, but got "
                f"{evaluations} and {batch_size}; raise what is too low."
            )
        self._space = space
        self._turns = Turns(evaluations, batch_size)
        self._rng = rng
        self._columns = ToldColumns(space.dim, fitness, dict(passive_fields or {}))
        self._told = [self._columns.none()]

    @property
    def done(self) -> bool:
        """Whether all evaluations are spent."""
        return self._turns.done

    @property
    def evaluations(self) -> int:
        """Number of evaluations told so far."""
        return self._turns.evaluations

    @property
    def stage(self) -> str:
        """What the method is doing: always the same."""
        return "sampling"

    @property
    def archive(self) -> None:
        """None: it has no archive."""
        return None

    @property
    def exploration(self) -> Mapping[str, int]:
        """Empty: it tries no fitness."""
        return {}

    @property
    def chosen(self) -> None:
        """None: it tries no fitness."""
        return None

    def output(self) -> Mapping[str, NDArray[Any]]:
        """Return all valid solutions so far, distinct, in the order of their evaluation.

        Returns:
            The columns `solution`, `objective` (NaN where undefined), `success` and `evaluation`,
            and the passive fields.
        """
        return stack(self._told).output()

    def ask(self) -> NDArray[np.float64]:
        """Return the next solutions.

        Returns:
            (n, dim) solutions, n being the batch size or what is left of the evaluations.

        Raises:
            MethodError: The ones before have not been told yet, or all is done.
        """
        return self._turns.ask(self._space.sample(self._turns.size(), rng=self._rng))

    def tell(self, values: Values) -> None:
        """Take what the solutions asked for last came to.

        After an error nothing has changed, and it may be called again.

        Args:
            values: As many as were asked for, with the fitness and every passive field.

        Raises:
            MethodError: Nothing was asked for, their number is another, or a column is missing or
                of another form.
        """
        told = self._columns.take(
            self._turns.asked(), values, first_evaluation=self._turns.evaluations
        )
        self._told.append(told.rows(told.valid))
        self._turns.tell()
