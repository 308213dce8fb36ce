"""The fields that a multi-BD archive stores, and the check of a batch against them."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from ribs.typing import BatchData, FieldDesc

from lqd_envs.errors import LQDError
from lqd_search.evaluation.values import check_block

_RESERVED = ("solution", "objective", "measures", "success", "threshold", "index")
_LOWEST = -np.finfo(np.float64).max


class ArchiveError(LQDError):
    """The archive was given what it cannot store, or asked for what it does not have."""


@dataclass(frozen=True)
class ArchiveFields:
    """The fields that a multi-BD archive stores: solution, objective, measures, success, extras.

    Attributes:
        descriptors: For each descriptor, in order, its number of measures.
        solution_dim: Length of a solution.
        extra: Further fields in pyribs' form, name to (shape, dtype).

    Raises:
        ArchiveError: There is no descriptor, one has no measures, or an extra field has a name
            that is taken or not an identifier.
    """

    descriptors: Mapping[str, int]
    solution_dim: int
    extra: FieldDesc

    def __post_init__(self) -> None:
        if not self.descriptors or min(self.descriptors.values()) < 1:
            raise ArchiveError(
                "Expected at least one descriptor, each with at least one measure, but got "
                f"{dict(self.descriptors)}; name what the archive is to tell apart."
            )
        for name in self.extra:
            if name in _RESERVED or not name.isidentifier():
                raise ArchiveError(
                    f"Expected extra fields whose names are identifiers other than "
                    f"{', '.join(_RESERVED)}, but got {name!r}; rename it."
                )

    @property
    def beside_measures(self) -> FieldDesc:
        """`success` and the extra fields, in pyribs' form."""
        return {"success": ((), np.bool_), **self.extra}

    @property
    def dtypes(self) -> dict[str, Any]:
        """The dtype of every field."""
        floats = dict.fromkeys(("solution", "objective", "measures"), np.dtype(np.float64))
        return floats | {name: np.dtype(d) for name, (_, d) in self.beside_measures.items()}

    def columns_of(self, descriptor: str) -> slice:
        """Return which columns of the measures of all descriptors are those of one.

        Args:
            descriptor: Its name.

        Returns:
            The columns.
        """
        lengths = list(self.descriptors.values())
        place = list(self.descriptors).index(descriptor)
        return slice(sum(lengths[:place]), sum(lengths[: place + 1]))

    def check(self, batch: Mapping[str, ArrayLike]) -> BatchData:
        """Check a batch as a whole and turn its columns into arrays of the fields' dtypes.

        Args:
            batch: For each field a column of N rows; the measures have NaN rows where undefined.

        Returns:
            The columns as arrays.

        Raises:
            ArchiveError: A field is missing or unknown, has another shape or a dtype that does
                not fit, or a solution or objective is not finite.
            ValuesError: A descriptor's measures are infinite, or NaN only in part of a row.
        """
        shapes = self._shapes()
        if set(batch) != set(shapes):
            raise ArchiveError(
                f"Expected the fields {', '.join(shapes)}, but got {', '.join(batch)}; "
                "pass each of them by its name."
            )
        dtypes = self.dtypes
        rows = _rows_of(batch["solution"])
        columns = {
            name: _column(name, batch[name], shape=(rows, *shape), dtype=dtypes[name])
            for name, shape in shapes.items()
        }
        if not np.isfinite(columns["solution"]).all():
            raise ArchiveError("Expected finite solutions, but got NaN or infinity; repair them.")
        # The lowest float64 is the threshold that keeps pyribs' own rule out of the way.
        if not (np.isfinite(columns["objective"]) & (columns["objective"] > _LOWEST)).all():
            raise ArchiveError(
                f"Expected finite objectives above {_LOWEST}, but got others; leave out the "
                "solutions whose objective is undefined."
            )
        self._check_measures(columns["measures"])
        return columns

    def empty_union(self) -> BatchData:
        """Return a column of no rows for each field but the measures."""
        dtypes = self.dtypes
        shapes = {name: shape for name, shape in self._shapes().items() if name != "measures"}
        return {name: np.empty((0, *shape), dtypes[name]) for name, shape in shapes.items()}

    def _check_measures(self, measures: NDArray[np.float64]) -> None:
        undefined = np.isnan(measures)
        lengths = list(self.descriptors.values())
        first = np.repeat(np.cumsum([0, *lengths[:-1]]), lengths)
        # All blocks at once, and one by one only to say which of them is wrong.
        whole = np.array_equal(undefined, undefined.take(first, axis=1))
        if not whole or np.isinf(measures).any():
            for name in self.descriptors:
                check_block(name, measures[:, self.columns_of(name)])

    def _shapes(self) -> dict[str, tuple[int, ...]]:
        extra = {name: row_shape(shape) for name, (shape, _) in self.beside_measures.items()}
        measures = sum(self.descriptors.values())
        return {"solution": (self.solution_dim,), "objective": (), "measures": (measures,), **extra}


def row_shape(shape: Any) -> tuple[int, ...]:
    """Return the shape of one row of a field, which pyribs lets be given as a number, too."""
    return (int(shape),) if isinstance(shape, int | np.integer) else tuple(map(int, shape))


def _rows_of(solution: ArrayLike) -> int:
    array = np.asarray(solution)
    if array.ndim == 0:
        raise ArchiveError(
            f"Expected a column of solutions, but got the single value {array}; pass a batch, or "
            "use add_single."
        )
    return len(array)


def _column(
    name: str, column: ArrayLike, *, shape: tuple[int, ...], dtype: np.dtype[Any]
) -> NDArray[Any]:
    array = np.asarray(column)
    if array.shape != shape:
        raise ArchiveError(
            f"Expected {name} to have shape {shape}, with one row per solution, but it has shape "
            f"{array.shape}; pass a row for each."
        )
    if not np.can_cast(array.dtype, dtype, "same_kind"):
        raise ArchiveError(
            f"Expected {name} to have dtype {dtype}, but it has {array.dtype}; convert it."
        )
    return array.astype(dtype, copy=False)
