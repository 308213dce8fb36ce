"""The elites of several grids as one set of distinct solutions."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lqd_search.archives.distinct import first_of_each, first_of_equal


@dataclass(frozen=True, eq=False)
class Elites:
    """The union of the grids' elites; two are the same if their solutions are equal.

    All arrays are read-only.

    Attributes:
        fields: For each field an array of m rows, `solution`, `objective` and `success` among
            them. Measures are not: each grid has its own.
        rows: For each grid (k,) indices into these rows, in the order of the grid's cells.
        cells: For each grid (k,) the ascending cells that these elites hold.
    """

    fields: Mapping[str, NDArray[Any]]
    rows: Mapping[str, NDArray[np.intp]]
    cells: Mapping[str, NDArray[np.intp]]

    def __len__(self) -> int:
        return len(self.fields["solution"])

    @property
    def successes(self) -> int:
        """Number of distinct successful solutions, by the inferred condition."""
        return int(self.fields["success"].sum())


def unite(
    grids: Mapping[str, Mapping[str, NDArray[Any]]], *, empty: Mapping[str, NDArray[Any]]
) -> Elites:
    """Unite the elites of several grids without duplicates.

    Of equal solutions the one with the lowest `evaluation` is kept, and the union is ordered by
    it. Where there is no such field, the first one is kept, and they are in the order of their
    first appearance, grid by grid and cell by cell.

    Args:
        grids: For each grid a column of k rows for each field, and the ascending cells as `index`.
        empty: A column of no rows for each field that the union shall have, `solution` and
            `success` among them.

    Returns:
        The union.
    """
    stacked = {
        name: np.concatenate([none, *(grid[name] for grid in grids.values())])
        for name, none in empty.items()
    }
    candidates, place = _candidates(stacked)
    solutions = stacked["solution"].take(candidates, axis=0)
    first = first_of_equal(solutions)
    kept = np.flatnonzero(first == np.arange(len(first)))
    row_of_candidate = np.empty(len(first), np.intp)
    row_of_candidate[kept] = np.arange(len(kept))
    row = row_of_candidate.take(first).take(place)
    ends = np.cumsum([0, *(len(grid["index"]) for grid in grids.values())])
    source = candidates.take(kept)
    return Elites(
        fields=_sealed({name: column.take(source, axis=0) for name, column in stacked.items()}),
        rows=_sealed({name: row[ends[i] : ends[i + 1]] for i, name in enumerate(grids)}),
        cells=_sealed({name: grid["index"].astype(np.intp) for name, grid in grids.items()}),
    )


def _candidates(stacked: Mapping[str, NDArray[Any]]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    # Rows in the order of the union, equal ones still among them; and each row's place in these.
    solution = stacked["solution"]
    if "evaluation" not in stacked:
        everything = np.arange(len(solution))
        return everything, everything
    first, place = first_of_each(stacked["evaluation"])
    # An evaluation is one solution, and comparing spares the hash of most rows. Should an archive
    # have been given several solutions as one evaluation, each row is a candidate of its own.
    if np.array_equal(solution, solution.take(first.take(place), axis=0)):
        return first, place
    order = np.argsort(stacked["evaluation"], kind="stable")
    place = np.empty(len(order), np.intp)
    place[order] = np.arange(len(order))
    return order, place


def _sealed(columns: dict[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
    for column in columns.values():
        column.setflags(write=False)
    return columns
