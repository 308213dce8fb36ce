"""How the descriptors' ranges are learned from what was observed."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from lqd_envs.errors import LQDError
from lqd_search.archives.grid_spec import GridSpec, learn_grid_spec

Measures = Mapping[str, NDArray[np.float64]]
"""For each descriptor (N, d) measures of the same N solutions, NaN rows where undefined."""


class ObservationError(LQDError):
    """A descriptor or an evaluation was not observed."""


@dataclass(frozen=True, eq=False)
class DescriptorRanges:
    """The descriptors' grids as far as they are known, and what the others have seen so far.

    A descriptor's grid is learned once it has taken `minimum` defined values; until then it waits.
    The object does not change: `observe` and `relearn` return what it would become.

    Attributes:
        descriptors: For each descriptor, in order, its number of measures.
        minimum: Number of defined values that a grid is learned from.
        cells: About as many cells each grid gets.
        specs: The grids known so far.
        seen: The (k, d) defined values of the waiting descriptors, if there are any.
    """

    descriptors: Mapping[str, int]
    minimum: int = 64
    cells: int = 10_000
    specs: Mapping[str, GridSpec] = field(default_factory=dict)
    seen: Measures = field(default_factory=dict)

    @property
    def waiting(self) -> tuple[str, ...]:
        """The descriptors whose grid is not known yet, in order."""
        return tuple(name for name in self.descriptors if name not in self.specs)

    def observe(self, measures: Measures) -> "DescriptorRanges":
        """Let the waiting descriptors see the measures of a batch.

        Args:
            measures: Of every valid solution of the batch.

        Returns:
            The ranges after it. Grids that were known stay as they are.

        Raises:
            ObservationError: A descriptor is missing.
        """
        _check_names(measures, self.descriptors)
        values = {
            name: np.concatenate([self.seen[name], _defined(measures[name])])
            if name in self.seen
            else _defined(measures[name])
            for name in self.waiting
        }
        return self._with(values, known=self.specs)

    def relearn(self, log: "ObservationLog") -> "DescriptorRanges":
        """Learn every grid again from everything observed so far.

        Args:
            log: Has all of it.

        Returns:
            The ranges after it. Descriptors that still lack values go on waiting, with those in
            the log as seen.
        """
        return self._with({name: log.defined(name) for name in self.descriptors}, known={})

    def _with(self, values: Measures, *, known: Mapping[str, GridSpec]) -> "DescriptorRanges":
        learned = {
            name: learn_grid_spec(column, cells=self.cells)
            for name, column in values.items()
            if len(column) >= max(self.minimum, 1)
        }
        specs = {**known, **learned}
        return replace(
            self,
            specs={name: specs[name] for name in self.descriptors if name in specs},
            seen={name: column for name, column in values.items() if name not in learned},
        )


class ObservationLog:
    """Everything observed so far, by all runs of a method, until the ranges are learned again.

    Args:
        descriptors: For each descriptor, in order, its number of measures.
    """

    def __init__(self, descriptors: Mapping[str, int]) -> None:
        self._descriptors = dict(descriptors)
        self._evaluations = [np.empty(0, np.int64)]
        self._measures = {name: [np.empty((0, d))] for name, d in descriptors.items()}

    def __len__(self) -> int:
        return sum(len(evaluation) for evaluation in self._evaluations)

    def record(self, evaluation: NDArray[np.int64], measures: Measures) -> None:
        """Record the measures of a batch.

        Args:
            evaluation: (N,) ids, each above all those recorded before it.
            measures: Of these N solutions, the valid ones.

        Raises:
            ObservationError: A descriptor is missing, or the ids do not ascend.
        """
        _check_names(measures, self._descriptors)
        if np.any(np.diff(evaluation, prepend=self._last) <= 0):
            raise ObservationError(
                f"Expected evaluation ids that ascend from {self._last + 1}, but got "
                f"{evaluation.tolist()[:3]} first; record each batch once, in order."
            )
        self._evaluations.append(np.array(evaluation, np.int64))
        for name, blocks in self._measures.items():
            blocks.append(np.array(measures[name]))

    def defined(self, name: str) -> NDArray[np.float64]:
        """Return all defined measures of a descriptor.

        Args:
            name: The descriptor.

        Returns:
            (k, d) rows, in the order of their evaluation.
        """
        return _defined(np.concatenate(self._measures[name]))

    def measures(self, evaluation: NDArray[np.int64]) -> dict[str, NDArray[np.float64]]:
        """Look up the measures of some evaluations.

        Args:
            evaluation: (n,) ids, in any order.

        Returns:
            For each descriptor (n, d) measures.

        Raises:
            ObservationError: One of them was not recorded.
        """
        recorded = np.concatenate(self._evaluations)
        rows = np.searchsorted(recorded, evaluation)
        missing = ~np.isin(evaluation, recorded)
        if missing.any():
            raise ObservationError(
                f"Expected evaluations that were recorded, but {evaluation[missing][0]} is none of "
                f"the {len(recorded)} in the log; record each batch before its measures are wanted."
            )
        return {name: np.concatenate(blocks)[rows] for name, blocks in self._measures.items()}

    @property
    def _last(self) -> int:
        return max((int(ids[-1]) for ids in self._evaluations if len(ids)), default=-1)


def _defined(measures: NDArray[np.float64]) -> NDArray[np.float64]:
    return measures[~np.isnan(measures[:, 0])]


def _check_names(measures: Measures, descriptors: Mapping[str, int]) -> None:
    missing = [name for name in descriptors if name not in measures]
    if missing:
        raise ObservationError(
            f"Expected the measures of every descriptor, but {', '.join(missing)} are missing; "
            f"got {', '.join(measures) or 'none'}."
        )
