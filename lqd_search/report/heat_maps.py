"""The heat maps of a report: a run's grids and the ground truth, seen along their axes."""

from collections.abc import Mapping, Sequence
from itertools import combinations
from typing import Any, TypeAlias, TypedDict

import numpy as np
from numpy.typing import NDArray

from lqd_envs import GroundTruth
from lqd_search.archives.worth import worth_of
from lqd_search.evaluation.motion_evaluator import EXPERT, GROUND_TRUTH
from lqd_search.report.numbers import rounded
from lqd_search.runs.stored_archive import StoredArchive, StoredGrid

Fields: TypeAlias = Mapping[str, NDArray[Any]]


class Panel(TypedDict):
    """A map seen along all axes but two: columns with an entry for each place that is filled.

    `place` is the flat index, first axis first; `filled`, `successes` and `experts` count the
    elites behind one another there, all of them and those that either condition approves; `elite`
    is the best of them, and `best` its fitness.
    """

    axes: list[int]
    place: list[int]
    filled: list[int]
    successes: list[int]
    experts: list[int]
    best: list[float | None]
    elite: list[int]
    evaluation: list[int]


class HeatMap(TypedDict):
    """One grid."""

    name: str
    title: str
    dims: list[int]
    ranges: list[list[float]]
    axes: list[str]
    filled: int
    successes: int
    panels: list[Panel]


def grid_map(name: str, grid: StoredGrid, *, fields: Fields) -> HeatMap:
    """Return a descriptor's grid, with a panel for each pair of its measures.

    Args:
        name: The descriptor.
        grid: Its grid.
        fields: The archive's columns.
    """
    successes = int(fields["success"][grid.elites].sum())
    dims = grid.spec.dims
    return {
        "name": name,
        "title": f"{len(grid.cells):,} of {grid.spec.cells:,} cells are filled, {successes:,} "
        "with a success",
        "dims": list(dims),
        "ranges": [list(bounds) for bounds in grid.spec.ranges],
        "axes": [f"measure {axis}" for axis in range(len(dims))],
        "filled": len(grid.cells),
        "successes": successes,
        "panels": _panels(dims, cells=grid.cells, elites=grid.elites, fields=fields),
    }


def ground_truth_map(ground_truth: GroundTruth, *, archive: StoredArchive) -> HeatMap:
    """Return the ground-truth grid, filled by the elites that the expert approves."""
    fields = archive.fields
    approved = np.flatnonzero(fields[EXPERT])
    cells = ground_truth.cells(fields[GROUND_TRUTH][approved])
    inside = cells >= 0
    filled = len(np.unique(cells[inside]))
    dims = ground_truth.dims
    return {
        "name": "ground truth",
        "title": f"{filled:,} of {int(np.prod(dims)):,} cells are filled; successes in them: "
        f"{int(inside.sum()):,}",
        "dims": list(dims),
        "ranges": [list(bounds) for bounds in ground_truth.ranges],
        "axes": list(ground_truth.names),
        "filled": filled,
        "successes": filled,
        "panels": _panels(dims, cells=cells[inside], elites=approved[inside], fields=fields),
    }


def _panels(
    dims: Sequence[int], *, cells: NDArray[np.int64], elites: NDArray[np.int64], fields: Fields
) -> list[Panel]:
    index = np.unravel_index(cells, tuple(dims))
    pairs: list[tuple[int, ...]] = list(combinations(range(len(dims)), 2)) or [(0,)]
    return [
        _panel(
            pair,
            places=np.ravel_multi_index(
                tuple(index[axis] for axis in pair), tuple(dims[axis] for axis in pair)
            ),
            elites=elites,
            fields=fields,
        )
        for pair in pairs
    ]


def _panel(
    pair: Sequence[int], *, places: NDArray[np.intp], elites: NDArray[np.int64], fields: Fields
) -> Panel:
    success, expert = fields["success"][elites], fields[EXPERT][elites]
    # The best comes first at its place: a success, then the higher fitness, then the earlier.
    order = np.lexsort((elites, -worth_of(fields["objective"])[elites], ~success, places))
    place, first, inverse = np.unique(places[order], return_index=True, return_inverse=True)
    best = elites[order][first]

    def count(rows: NDArray[np.bool_]) -> list[int]:
        counted: list[int] = np.bincount(inverse[rows[order]], minlength=len(place)).tolist()
        return counted

    return {
        "axes": list(pair),
        "place": place.tolist(),
        "filled": count(np.ones(len(elites), dtype=np.bool_)),
        "successes": count(success),
        "experts": count(expert),
        "best": rounded(fields["objective"][best]),
        "elite": best.tolist(),
        "evaluation": fields["evaluation"][best].tolist(),
    }
