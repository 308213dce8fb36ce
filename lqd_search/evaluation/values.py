"""What one batch of evaluated solutions came to, as a search may see it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lqd_envs.errors import LQDError


class ValuesError(LQDError):
    """The columns of a batch do not fit together."""


@dataclass(frozen=True)
class Refusal:
    """A functional whose value was refused, and how often in one batch.

    Attributes:
        functional: The functional's name.
        kind: `"success"`, `"fitness"`, `"timestamp"`, `"quantity"` or `"descriptor"`.
        count: Number of motions of the batch in which it was refused for this reason.
        reason: What was wrong with the value, such as `"raised KeyError in line 2"`.
        first_motion: Index in the batch of the first such motion.
    """

    functional: str
    kind: str
    count: int
    reason: str
    first_motion: int


@dataclass(frozen=True)
class StoppedFunction:
    """A functional that was stopped from outside, and that no search may rely on any more.

    Attributes:
        functional: The functional's name, as in a `Refusal`.
        kind: Its kind, as in a `Refusal`.
        reason: Why, in words that complete "it ...".
    """

    functional: str
    kind: str
    reason: str

    def __str__(self) -> str:
        """Return this as a sentence."""
        return (
            f"The {self.kind} function {self.functional!r} is not used any more: it {self.reason}."
        )


@dataclass(frozen=True, eq=False)
class Values:
    """What a batch of N evaluated solutions came to.

    Attributes:
        valid: (N,) bool. False: rejected or discarded before it was judged, never inserted.
        success: (N,) bool, the inferred condition. False wherever `valid` is, and where the
            condition's verdict was refused.
        fitness: For each fitness function (N,) float64; NaN: undefined or refused.
        measures: For each descriptor (N, d) float64; a row of only NaN: undefined.
        refusals: The functionals whose values were refused in this batch.
        stopped: The functionals that were stopped while this batch was judged, each once. As long
            as they are called at all, what is refused of them depends on where that happened;
            `WithoutStopped` evaluates such a batch again without them.
        passive: Columns with N rows that are carried along and stored with the elites, and that no
            search reads, such as the expert's verdict.
        perceived: Further columns with N rows that the robot perceived itself, and that a search
            may read, such as where it first touched something.

    Raises:
        ValuesError: A column is no array, has another length, dtype or number of dimensions, an
            infinite value, or a row of measures that is NaN only in part; an invalid solution is
            successful; or a passive and a perceived column have the same name.
    """

    valid: NDArray[np.bool_]
    success: NDArray[np.bool_]
    fitness: Mapping[str, NDArray[np.float64]]
    measures: Mapping[str, NDArray[np.float64]]
    refusals: tuple[Refusal, ...] = ()
    passive: Mapping[str, NDArray[Any]] = field(default_factory=dict)
    perceived: Mapping[str, NDArray[Any]] = field(default_factory=dict)
    stopped: tuple[StoppedFunction, ...] = ()

    def __post_init__(self) -> None:
        self._check("valid", self.valid, dtype=np.bool_, ndim=1)
        self._check("success", self.success, dtype=np.bool_, ndim=1)
        if np.any(self.success & ~self.valid):
            row = int(np.argmax(self.success & ~self.valid))
            raise ValuesError(
                f"A success must be valid, but row {row} is successful and not valid; "
                "set its success to False."
            )
        for name, fitness in self.fitness.items():
            self._check(f"fitness {name!r}", fitness, dtype=np.float64, ndim=1)
            if np.any(np.isinf(fitness)):
                raise ValuesError(
                    f"Expected fitness {name!r} to be finite, or NaN where it is undefined, but "
                    "it has infinite values; refuse them."
                )
        for name, measures in self.measures.items():
            self._check(f"measures {name!r}", measures, dtype=np.float64, ndim=2)
            check_block(name, measures)
        for name, column in self.passive.items():
            self._check(f"passive column {name!r}", column)
        for name, column in self.perceived.items():
            self._check(f"perceived column {name!r}", column)
            if name in self.passive:
                raise ValuesError(
                    f"Expected passive and perceived columns of different names, but both have "
                    f"{name!r}; rename one."
                )

    def __len__(self) -> int:
        return len(self.valid)

    @property
    def valid_measures(self) -> dict[str, NDArray[np.float64]]:
        """For each descriptor, in order, the (n, d) measures of the n valid solutions."""
        return {name: measures[self.valid] for name, measures in self.measures.items()}

    def rows(self, rows: NDArray[np.intp]) -> "Values":
        """Return the chosen solutions alone; what is said of the whole batch is left out."""
        return Values(
            valid=self.valid[rows],
            success=self.success[rows],
            fitness={name: column[rows] for name, column in self.fitness.items()},
            measures={name: column[rows] for name, column in self.measures.items()},
            passive={name: column[rows] for name, column in self.passive.items()},
            perceived={name: column[rows] for name, column in self.perceived.items()},
        )

    def _check(
        self, name: str, column: NDArray[Any], *, dtype: type | None = None, ndim: int | None = None
    ) -> None:
        if not isinstance(column, np.ndarray):
            raise ValuesError(
                f"Expected {name} to be a NumPy array, but it is a {type(column).__name__}; "
                "convert it with np.array."
            )
        length = self.valid.size
        shape = "(N,)" if ndim == 1 else "(N, d)" if ndim == 2 else "(N, ...)"
        if column.ndim != (ndim or max(column.ndim, 1)) or len(column) != length:
            raise ValuesError(
                f"Expected {name} to have shape {shape} with N = {length}, the length of 'valid', "
                f"but it has shape {column.shape}; give a row for each solution."
            )
        if dtype is not None and column.dtype != dtype:
            raise ValuesError(
                f"Expected {name} to have dtype {np.dtype(dtype)}, but it has {column.dtype}; "
                "convert it."
            )


def check_block(name: str, measures: NDArray[np.float64]) -> None:
    """Check that each row of one descriptor's measures is finite, or undefined as a whole.

    Args:
        name: The descriptor's name, for the message.
        measures: (N, d) float64 with d at least 1.

    Raises:
        ValuesError: There are no columns, or a row is infinite or NaN only in part.
    """
    if measures.shape[1] == 0:
        raise ValuesError(
            f"Expected measures {name!r} to have at least one column, but got none; leave the "
            "descriptor out."
        )
    undefined = np.flatnonzero(~np.isfinite(measures).all(axis=1))
    wrong = undefined[~np.isnan(measures[undefined]).all(axis=1)]
    if len(wrong):
        raise ValuesError(
            f"Expected each row of measures {name!r} to be finite, or all NaN where it is "
            f"undefined, but row {wrong[0]} is {measures[wrong[0]].tolist()}; make all of it NaN."
        )
