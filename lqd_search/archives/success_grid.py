"""One descriptor's grid: a pyribs `GridArchive` in which success comes first."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from ribs.archives import GridArchive
from ribs.typing import BatchData, FieldDesc

from lqd_search.archives.cell_rows import CellElites, CellRows, Rows, pack, row_dtype
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
        winners: (w,) indices of the batch's rows that get in, in the order of their cells.
        occupied: (w,) bool, whether these cells have an elite already.
        elites: The winners.
        replaced: The elites that make room for them.
        clipped: Number of offered rows with a measure out of range.
        clipped_before: The grid's count of such rows before.
    """

    offered: NDArray[np.intp]
    value: NDArray[np.float64]
    winners: NDArray[np.intp]
    occupied: NDArray[np.bool_]
    elites: CellElites
    replaced: CellElites
    clipped: int
    clipped_before: int


class _FarGridArchive(GridArchive):
    """A `GridArchive` that finds the cell at the edge for measures however far out of range."""

    def index_of(self, measures: ArrayLike) -> NDArray[np.int32]:
        reach = _REACH_IN_RANGES * self.interval_size
        return super().index_of(
            np.clip(measures, self.lower_bounds - reach, self.upper_bounds + reach)
        )


class SuccessGrid:
    """One descriptor's grid: a pyribs `GridArchive` in which success comes first.

    The elites are kept twice, in the pyribs archive and as rows by cell. From these the archive is
    made again after an error or after unpickling, once it is wanted; and they are quicker to read.

    Args:
        spec: Cells and ranges.
        solution_dim: Length of a solution.
        fields: Fields beside solution, objective and measures, in pyribs' form; among them
            `success`.

    Attributes:
        spec: Cells and ranges.
        clipped: Number of solutions offered so far with a measure out of range.
    """

    def __init__(self, spec: GridSpec, *, solution_dim: int, fields: FieldDesc) -> None:
        self.spec = spec
        self.clipped = 0
        self._solution_dim = solution_dim
        self._fields = fields
        self._archive: GridArchive | None = None
        self._cells = CellRows(
            spec.cells,
            measures=len(spec.dims),
            dtype=row_dtype(solution_dim=solution_dim, fields=fields),
        )

    def __len__(self) -> int:
        """Return the number of elites."""
        return len(self._cells)

    @property
    def successes(self) -> int:
        """Number of elites that are successes."""
        return int(np.count_nonzero(self._cells.success))

    @property
    def archive(self) -> GridArchive:
        """The pyribs archive, to be read only; another one after an error or after unpickling."""
        if self._archive is None:
            archive = self._new_archive()
            if len(self):
                _offer(archive, self.elites())
            self._archive = archive
        return self._archive

    def plan(
        self,
        batch: Rows,
        measures: NDArray[np.float64],
        *,
        competition: Competition,
    ) -> Insertion:
        """Find out what a batch would change, without changing anything.

        Args:
            batch: (N,) rows, checked.
            measures: (N, d) float64, NaN rows where undefined, checked.
            competition: The rule by which a cell is won.

        Returns:
            The changes, for `insert`.
        """
        offered = np.flatnonzero(~np.isnan(measures[:, 0]))
        defined = _rows_of(measures, offered)
        cell = self.archive.index_of(defined)
        candidates = Candidates(
            cell, batch["success"].take(offered), batch["objective"].take(offered)
        )
        incumbents = Incumbents(
            self._cells.occupied.take(cell),
            self._cells.success.take(cell),
            self._cells.objective.take(cell),
        )
        won = competition(candidates, incumbents)
        # Memory is written faster in its own order.
        won = won.take(np.argsort(cell.take(won), kind="stable"))
        winners, won_cell, occupied = (
            offered.take(won),
            cell.take(won),
            incumbents.occupied.take(won),
        )
        with np.errstate(over="ignore"):
            value = candidates.objective - incumbents.objective
        return Insertion(
            offered=offered,
            value=value,
            winners=winners,
            occupied=occupied,
            elites=CellElites(won_cell, batch.take(winners), _rows_of(defined, won)),
            replaced=self._cells.read(won_cell[occupied]),
            clipped=int(np.count_nonzero(self.spec.out_of_range(defined))),
            clipped_before=self.clipped,
        )

    def insert(self, insertion: Insertion) -> None:
        """Make the changes that `plan` found.

        Args:
            insertion: What `plan` returned for the grid as it is now.
        """
        if len(insertion.winners):
            _offer(self.archive, insertion.elites.columns())
            self._cells.write(insertion.elites)
        self.clipped += insertion.clipped

    def undo(self, insertion: Insertion) -> None:
        """Bring the grid back to what it was before an `insert`, even one that failed halfway.

        Args:
            insertion: What was given to `insert`.
        """
        # The error may be a lack of memory or an impatient user: the pyribs archive, of which
        # nothing is known, is not made again here and now.
        self._archive = None
        self._cells.undo(insertion.elites, replaced=insertion.replaced)
        self.clipped = insertion.clipped_before

    def elites(self) -> BatchData:
        """Return the elites in the order of their cells, whenever these were filled.

        Returns:
            (m, ...) read-only columns of every field, with the cell as `index`; the same arrays
            until an elite changes.
        """
        return self._cells.in_order()

    def __reduce__(self) -> tuple[Any, ...]:
        """Return what a copy needs: each elite once, and no empty cell."""
        return _restored, (self.spec, self._solution_dim, self._fields, self.elites(), self.clipped)

    def _new_archive(self) -> GridArchive:
        # GridArchive knows no success and would let a failure of higher objective evict one. Who
        # gets in is decided in `plan`; a threshold that starts below every objective and never
        # learns makes GridArchive accept whoever it is given. Ranges are learned, so nothing is
        # meant to lie exactly on a boundary, and pyribs' epsilon would shift cells narrower than
        # it: it is 0.
        return _FarGridArchive(
            solution_dim=self._solution_dim,
            dims=self.spec.dims,
            ranges=self.spec.ranges,
            learning_rate=0.0,
            threshold_min=-np.finfo(np.float64).max,
            epsilon=0.0,
            seed=0,
            extra_fields=self._fields,
        )


def _rows_of(measures: NDArray[np.float64], rows: NDArray[np.intp]) -> NDArray[np.float64]:
    # Measures lie column by column: with so few columns numpy is faster along these, and so is
    # pyribs, which computes the cells from them.
    return measures.T.take(rows, axis=1).T


def _offer(archive: GridArchive, elites: BatchData) -> None:
    # pyribs sums the objectives and subtracts the threshold from them, which may overflow; nothing
    # here reads the results.
    fields = {name: column for name, column in elites.items() if name != "index"}
    with np.errstate(over="ignore", invalid="ignore"):
        archive.add(**fields)


def _restored(
    spec: GridSpec, solution_dim: int, fields: FieldDesc, elites: BatchData, clipped: int
) -> SuccessGrid:
    grid = SuccessGrid(spec, solution_dim=solution_dim, fields=fields)
    rows = pack(elites, dtype=row_dtype(solution_dim=solution_dim, fields=fields))
    grid._cells.write(CellElites(elites["index"], rows, elites["measures"]))
    grid.clipped = clipped
    return grid
