"""One descriptor's grid: a pyribs `GridArchive` in which success comes first."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from ribs.archives import GridArchive
from ribs.typing import BatchData, FieldDesc

from lqd_search.archives.competition import Candidates, Competition, Incumbents
from lqd_search.archives.grid_spec import GridSpec

# pyribs casts a measure's cell to int32 before it clips it, so a measure that lies too far out
# would wrap round to the wrong edge.
_REACH_IN_RANGES = 1000.0


@dataclass(frozen=True, eq=False)
class Insertion:
    """What a batch would change in one grid, and what it takes to undo it.

    Attributes:
        offered: (k,) indices of the batch's rows that are defined in this grid.
        value: (k,) float64, their objective less that of the elite in their cell, if there is one.
        winners: (w,) indices of the batch's rows that get in.
        cell: (w,) the winners' cells.
        occupied: (w,) bool, whether these cells have an elite already.
        elites: For each field the winners' (w, ...) rows.
        replaced: For each field the rows of the elites that make room, in the winners' order.
        clipped: Number of offered rows with a measure out of range.
    """

    offered: NDArray[np.intp]
    value: NDArray[np.float64]
    winners: NDArray[np.intp]
    cell: NDArray[np.integer]
    occupied: NDArray[np.bool_]
    elites: BatchData
    replaced: BatchData
    clipped: int


class SuccessGrid:
    """One descriptor's grid: a pyribs `GridArchive` in which success comes first.

    Args:
        spec: Cells and ranges.
        solution_dim: Length of a solution.
        fields: Fields beside solution, objective and measures, in pyribs' form; among them
            `success`.

    Attributes:
        archive: The pyribs archive, to be read only.
        spec: Cells and ranges.
        clipped: Number of solutions offered so far with a measure out of range.
    """

    def __init__(self, spec: GridSpec, *, solution_dim: int, fields: FieldDesc) -> None:
        self.spec = spec
        self.clipped = 0
        self._solution_dim = solution_dim
        self._fields = fields
        bounds = np.array(spec.ranges)
        reach = _REACH_IN_RANGES * (bounds[:, 1] - bounds[:, 0])
        self._nearest, self._farthest = bounds[:, 0] - reach, bounds[:, 1] + reach
        self._fill({})

    def plan(
        self,
        batch: Mapping[str, NDArray[Any]],
        measures: NDArray[np.float64],
        *,
        competition: Competition,
    ) -> Insertion:
        """Find out what a batch would change, without changing anything.

        Args:
            batch: (N, ...) rows of every field but the measures, checked.
            measures: (N, d) float64, NaN rows where undefined, checked.
            competition: The rule by which a cell is won.

        Returns:
            The changes, for `insert`.
        """
        offered = np.flatnonzero(~np.isnan(measures[:, 0]))
        reachable = measures[offered]
        clipped = self.spec.out_of_range(reachable)
        if clipped.any():
            reachable[clipped] = np.clip(reachable[clipped], self._nearest, self._farthest)
        cell = self.archive.index_of(reachable)
        occupied, success, objective = self._incumbents
        candidates = Candidates(cell, batch["success"][offered], batch["objective"][offered])
        incumbents = Incumbents(occupied[cell], success[cell], objective[cell])
        won = competition(candidates, incumbents)
        winners, won_measures = offered[won], reachable[won]
        with np.errstate(over="ignore"):
            value = candidates.objective - incumbents.objective
        return Insertion(
            offered=offered,
            value=value,
            winners=winners,
            cell=cell[won],
            occupied=incumbents.occupied[won],
            elites={name: column[winners] for name, column in batch.items()}
            | {"measures": won_measures},
            replaced=self.archive.retrieve(won_measures[incumbents.occupied[won]])[1],
            clipped=int(clipped.sum()),
        )

    def insert(self, insertion: Insertion) -> None:
        """Make the changes that `plan` found.

        Args:
            insertion: What `plan` returned for the grid as it is now.
        """
        self._put(insertion.elites, cell=insertion.cell)
        self.clipped += insertion.clipped

    def undo(self, insertion: Insertion, *, clipped: int) -> None:
        """Bring the grid back to what it was before an `insert`, even one that failed halfway.

        Args:
            insertion: What was given to `insert`.
            clipped: The count before it.
        """
        now = self.archive.data()
        untouched = ~np.isin(now["index"], insertion.cell)
        self._fill(
            {
                name: np.concatenate([now[name][untouched], column])
                for name, column in insertion.replaced.items()
            }
        )
        self.clipped = clipped

    def elites(self) -> BatchData:
        """Return the elites in the order of their cells, whenever these were filled.

        Returns:
            (m, ...) rows of every field, with the cell as `index`.
        """
        data = self.archive.data()
        order = np.argsort(data["index"])
        return {name: column[order] for name, column in data.items() if name != "threshold"}

    def _fill(self, elites: BatchData) -> None:
        # GridArchive knows no success and would let a failure of higher objective evict one. Who
        # gets in is decided in `plan`; a threshold that starts below every objective and never
        # learns makes GridArchive accept whoever it is given. Ranges are learned, so nothing is
        # meant to lie exactly on a boundary, and pyribs' epsilon would shift cells narrower than
        # it: it is 0.
        self.archive = GridArchive(
            solution_dim=self._solution_dim,
            dims=self.spec.dims,
            ranges=self.spec.ranges,
            learning_rate=0.0,
            threshold_min=-np.finfo(np.float64).max,
            epsilon=0.0,
            seed=0,
            extra_fields=self._fields,
        )
        # What the competition reads of each cell: occupied, success, objective. Retrieving whole
        # elites for every candidate would double the cost of a batch.
        cells = self.spec.cells
        self._incumbents = (np.zeros(cells, bool), np.zeros(cells, bool), np.zeros(cells))
        if elites:
            fields = {k: v for k, v in elites.items() if k not in ("threshold", "index")}
            self._put(fields, cell=elites["index"])

    def _put(self, elites: BatchData, *, cell: NDArray[np.integer]) -> None:
        if len(cell) == 0:
            return
        # pyribs sums the objectives and subtracts the threshold from them, which may overflow;
        # nothing here reads the results.
        with np.errstate(over="ignore", invalid="ignore"):
            self.archive.add(**elites)
        occupied, success, objective = self._incumbents
        occupied[cell] = True
        success[cell] = elites["success"]
        objective[cell] = elites["objective"]


def insert_all(plans: Sequence[tuple[SuccessGrid, Insertion]]) -> None:
    """Make the changes in all grids or, after an error, in none.

    Args:
        plans: Each grid with what its `plan` returned.
    """
    touched: list[tuple[SuccessGrid, Insertion, int]] = []
    complete = False
    try:
        for grid, plan in plans:
            touched.append((grid, plan, grid.clipped))
            grid.insert(plan)
        complete = True
    finally:
        if not complete:
            for grid, plan, clipped in touched:
                grid.undo(plan, clipped=clipped)
