"""The columns that a method without an archive keeps of what it is told."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from ribs.typing import FieldDesc

from lqd_search.archives.archive_fields import row_shape
from lqd_search.evaluation.values import Values
from lqd_search.methods.method import MethodError

_OWN = ("solution", "objective", "success", "evaluation")


@dataclass(frozen=True, eq=False)
class Told:
    """Solutions that a method was told the values of.

    Attributes:
        valid: (n,) bool, whether the solution did not fail.
        columns: `solution`, `objective` (NaN where undefined), `success`, `evaluation` and the
            passive fields, with n rows each.
    """

    valid: NDArray[np.bool_]
    columns: Mapping[str, NDArray[Any]]

    def __len__(self) -> int:
        return len(self.valid)

    def rows(self, rows: NDArray[np.intp] | NDArray[np.bool_]) -> "Told":
        """Return the chosen solutions alone."""
        return Told(self.valid[rows], {name: c[rows] for name, c in self.columns.items()})

    def output(self) -> dict[str, NDArray[Any]]:
        """Return the columns of the valid solutions, in the order of their evaluation.

        Of equal solutions the one that was evaluated first is returned.
        """
        valid = np.flatnonzero(self.valid)
        order = valid[np.argsort(self.columns["evaluation"][valid])]
        _, first = np.unique(self.columns["solution"][order], axis=0, return_index=True)
        kept = order[np.sort(first)]
        return {name: column[kept] for name, column in self.columns.items()}


def stack(told: Sequence[Told]) -> Told:
    """Join batches with the same columns, of which there is at least one."""
    return Told(
        np.concatenate([batch.valid for batch in told]),
        {name: np.concatenate([b.columns[name] for b in told]) for name in told[0].columns},
    )


@dataclass(frozen=True)
class ToldColumns:
    """Which columns are kept, and their check.

    Attributes:
        solution_dim: Length of a solution.
        fitness: Name of the fitness that is the objective.
        passive: The passive fields to keep, in pyribs' form.

    Raises:
        MethodError: A passive field has the name of another column.
    """

    solution_dim: int
    fitness: str
    passive: FieldDesc

    def __post_init__(self) -> None:
        for name in self.passive:
            if name in _OWN:
                raise MethodError(
                    f"Expected passive fields with names other than {', '.join(_OWN)}, but got "
                    f"{name!r}; rename it."
                )

    def none(self) -> Told:
        """Return the columns without a row."""
        columns: dict[str, NDArray[Any]] = {
            "solution": np.empty((0, self.solution_dim)),
            "objective": np.empty(0),
            "success": np.empty(0, np.bool_),
            "evaluation": np.empty(0, np.int64),
        }
        passive = {
            name: np.empty((0, *row_shape(shape)), dtype)
            for name, (shape, dtype) in self.passive.items()
        }
        return Told(np.empty(0, np.bool_), columns | passive)

    def take(
        self, solutions: NDArray[np.float64], values: Values, *, first_evaluation: int
    ) -> Told:
        """Take from a batch what is kept of it.

        Args:
            solutions: (n, dim) float64.
            values: What they came to.
            first_evaluation: Evaluation of the first one; the others follow.

        Returns:
            All n of them.

        Raises:
            MethodError: There is another number of values, or the fitness or a passive field is
                missing or of another form.
        """
        n = len(solutions)
        if len(values) != n:
            raise MethodError(
                f"Expected the values of {n} solutions, but got {len(values)}; pass those of the "
                "solutions asked for last."
            )
        _check_name("fitness", self.fitness, values.fitness)
        columns: dict[str, NDArray[Any]] = {
            "solution": solutions.copy(),
            "objective": values.fitness[self.fitness].copy(),
            "success": values.success.copy(),
            "evaluation": first_evaluation + np.arange(n, dtype=np.int64),
        }
        for name, (shape, dtype) in self.passive.items():
            _check_name("passive column", name, values.passive)
            columns[name] = _column(
                name, values.passive[name], shape=(n, *row_shape(shape)), dtype=np.dtype(dtype)
            )
        return Told(values.valid.copy(), columns)


def _check_name(kind: str, name: str, there: Mapping[str, Any]) -> None:
    if name not in there:
        raise MethodError(
            f"Expected the {kind} {name!r} among the values, but there are only "
            f"{', '.join(there) or 'none'}; let the evaluation give it too."
        )


def _column(
    name: str, column: NDArray[Any], *, shape: tuple[int, ...], dtype: np.dtype[Any]
) -> NDArray[Any]:
    if column.shape != shape or not np.can_cast(column.dtype, dtype, "same_kind"):
        raise MethodError(
            f"Expected passive column {name!r} to have shape {shape} and dtype {dtype}, but it has "
            f"{column.shape} and {column.dtype}; convert it."
        )
    return column.astype(dtype)
