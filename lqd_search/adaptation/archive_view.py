"""What a selector may see of an archive: what the run stored, but for the expert's own columns."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from lqd_search.runs.stored_archive import StoredArchive, StoredGrid


@dataclass(frozen=True, eq=False)
class ArchiveView:
    """What a run stores of its elites, without the expert's verdict and the ground truth.

    A robot has no expert. Whatever chooses motions is handed this and nothing else, so that it
    cannot look at either by mistake. In a run that the expert steered, that of `handcrafted`,
    objective, success and measures are the expert's themselves: whatever chooses by them there
    chooses with an expert's knowledge.

    Attributes:
        solution: (n, 9) float64.
        objective: (n,) float64, the fitness that steered the run; NaN where undefined.
        success: (n,) bool, the condition that steered it, which is the inferred one or the
            expert's.
        digest: (n,) uint64 fingerprint of the motion; equal where motions are.
        measures: For each grid, (n, d) float64 measures in shares of the grid's ranges, 0 to 1;
            NaN where the elite holds no cell of that grid.
    """

    solution: NDArray[np.float64]
    objective: NDArray[np.float64]
    success: NDArray[np.bool_]
    digest: NDArray[np.uint64]
    measures: Mapping[str, NDArray[np.float64]]

    @classmethod
    def of(cls, archive: StoredArchive) -> "ArchiveView":
        """Return the view of a whole archive, row by row."""
        n = len(archive)
        return cls(
            solution=archive.fields["solution"],
            objective=archive.fields["objective"],
            success=archive.fields["success"],
            digest=archive.fields["digest"],
            measures={name: _measures(grid, n) for name, grid in archive.grids.items()},
        )

    def __len__(self) -> int:
        """Return the number of elites."""
        return len(self.solution)

    def rows(self, rows: NDArray[np.intp]) -> "ArchiveView":
        """Return the view of the chosen elites, in the order of `rows`."""
        return ArchiveView(
            solution=self.solution[rows],
            objective=self.objective[rows],
            success=self.success[rows],
            digest=self.digest[rows],
            measures={name: column[rows] for name, column in self.measures.items()},
        )


def _measures(grid: StoredGrid, n: int) -> NDArray[np.float64]:
    lower, upper = np.array(grid.spec.ranges).T
    measures = np.full((n, len(lower)), np.nan)
    # A measure out of range, perhaps far out, is in a cell at the edge.
    measures[grid.elites] = (np.clip(grid.measures, lower, upper) - lower) / (upper - lower)
    return measures
