"""The elites of several grids as one set of distinct solutions."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class Elites:
    """The union of the grids' elites; two are the same if their solutions are equal.

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
    order = np.arange(len(stacked["solution"]))
    if "evaluation" in stacked:
        order = np.argsort(stacked["evaluation"], kind="stable")
    _, first, group = np.unique(
        stacked["solution"][order], axis=0, return_index=True, return_inverse=True
    )
    place_of_group = np.argsort(np.argsort(first))
    row = np.empty(len(order), np.intp)
    row[order] = place_of_group[group]
    ends = np.cumsum([0, *(len(grid["index"]) for grid in grids.values())])
    return Elites(
        fields={name: column[order[np.sort(first)]] for name, column in stacked.items()},
        rows={name: row[ends[i] : ends[i + 1]] for i, name in enumerate(grids)},
        cells={name: grid["index"].astype(np.intp) for name, grid in grids.items()},
    )
