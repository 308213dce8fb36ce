"""The elites of one grid as rows by cell, from which the grid can be made again."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from ribs.typing import BatchData, FieldDesc

Rows = NDArray[np.void]
"""Structured rows of every field but the measures: together in memory, they are quick to move."""


@dataclass(frozen=True, eq=False)
class CellElites:
    """The elites of some cells.

    Attributes:
        cell: (k,) integers, the cells, no two the same.
        rows: (k,) rows.
        measures: (k, d) float64.
    """

    cell: NDArray[np.integer]
    rows: Rows
    measures: NDArray[np.float64]

    def __len__(self) -> int:
        """Return the number of elites."""
        return len(self.cell)

    def columns(self) -> BatchData:
        """Return for each field the (k, ...) column, solution, objective and measures first."""
        columns = {name: self.rows[name] for name in self.rows.dtype.names or ()}
        first = {name: columns.pop(name) for name in ("solution", "objective")}
        return {**first, "measures": self.measures, **columns}


class CellRows:
    """The elites of one grid, of which each cell holds one or none.

    Rows lie in the order in which their cells were first filled: what a young grid has is
    together in memory, and cells that stay empty take next to none.

    Args:
        cells: Number of cells, all of them empty.
        measures: Number of measures.
        dtype: That of a row, from `row_dtype`.

    Attributes:
        occupied: (cells,) bool, whether there is an elite.
        success: (cells,) bool, that of the elite; False in an empty cell.
        objective: (cells,) float64, that of the elite; 0 in an empty cell.
    """

    def __init__(self, cells: int, *, measures: int, dtype: np.dtype[np.void]) -> None:
        # A competition reads these of all candidates' cells, and columns stay in the cache.
        self.occupied = np.zeros(cells, bool)
        self.success = np.zeros(cells, bool)
        self.objective = np.zeros(cells)
        # The m elites have the places 0 to m - 1.
        self._place = np.zeros(cells, np.intp)
        self._rows: Rows = np.zeros(0, dtype)
        self._measures = np.zeros((0, measures))
        self._in_order: BatchData | None = None

    def __len__(self) -> int:
        """Return the number of elites."""
        return int(np.count_nonzero(self.occupied))

    def read(self, cell: NDArray[np.integer]) -> CellElites:
        """Return a copy of the elites of (k,) occupied cells."""
        place = self._place.take(cell)
        return CellElites(cell, self._rows.take(place), self._measures.take(place, axis=0))

    def write(self, elites: CellElites) -> None:
        """Let these elites hold their cells."""
        self._in_order = None
        new = elites.cell[~self.occupied.take(elites.cell)]
        filled = len(self)
        self._place[new] = np.arange(filled, filled + len(new))
        self._rows = self._roomy(self._rows, filled + len(new))
        self._measures = self._roomy(self._measures, filled + len(new))
        place = self._place.take(elites.cell)
        _opaque(self._rows)[place] = _opaque(elites.rows)
        self._measures[place] = elites.measures
        self.success[elites.cell] = elites.rows["success"]
        self.objective[elites.cell] = elites.rows["objective"]
        self.occupied[elites.cell] = True

    def undo(self, elites: CellElites, *, replaced: CellElites) -> None:
        """Take back the last `write`, even one that was not completed, or not even begun.

        Args:
            elites: What was written.
            replaced: What `read` returned for those of its cells that were occupied before it.
        """
        self._in_order = None
        new = np.setdiff1d(elites.cell, replaced.cell)
        self.occupied[new] = False
        self.success[new] = False
        self.objective[new] = 0.0
        self.write(replaced)

    def in_order(self) -> BatchData:
        """Return the elites in the order of their cells, whenever these were filled.

        Returns:
            (m, ...) read-only columns of every field, with the cell as `index`; the same arrays
            until the next change.
        """
        if self._in_order is None:
            elites = self.read(np.flatnonzero(self.occupied))
            columns = elites.columns() | {"index": elites.cell.astype(np.int32)}
            in_order = {name: np.ascontiguousarray(column) for name, column in columns.items()}
            for column in in_order.values():
                column.setflags(write=False)
            self._in_order = in_order
        return dict(self._in_order)

    def _roomy(self, rows: NDArray[Any], needed: int) -> NDArray[Any]:
        if needed <= len(rows):
            return rows
        room = min(max(needed, 2 * len(rows)), len(self.occupied))
        larger = np.empty((room, *rows.shape[1:]), rows.dtype)
        larger[: len(rows)] = rows
        return larger


def row_dtype(*, solution_dim: int, fields: FieldDesc) -> np.dtype[np.void]:
    """Return the dtype of a row: solution, objective, and further fields in pyribs' form.

    Args:
        solution_dim: Length of a solution.
        fields: Fields beside solution, objective and measures.

    Returns:
        A structured dtype.
    """
    first = [("solution", np.float64, (solution_dim,)), ("objective", np.float64, ())]
    rest = [(name, dtype, shape) for name, (shape, dtype) in fields.items()]
    return np.dtype([*first, *rest], align=True)


def pack(columns: Mapping[str, NDArray[Any]], *, dtype: np.dtype[np.void]) -> Rows:
    """Return columns as rows.

    Args:
        columns: For each field of `dtype`, and perhaps others, N rows.
        dtype: From `row_dtype`.

    Returns:
        (N,) rows.
    """
    rows: Rows = np.empty(len(columns["solution"]), dtype)
    for name in dtype.names or ():
        rows[name] = columns[name]
    return rows


def _opaque(rows: Rows) -> NDArray[np.void]:
    # Numpy assigns structured rows field by field, and ten times slower than plain bytes.
    return rows if rows.dtype.hasobject else rows.view(f"V{rows.dtype.itemsize}")
