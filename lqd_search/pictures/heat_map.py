"""One grid of a multi-BD archive, seen along its axes."""

from collections.abc import Mapping
from itertools import combinations
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from lqd_search.pictures.figure import FAILURE_COLOR, SUCCESS_COLORS, new_figure, new_panels, png
from lqd_search.runs.stored_archive import StoredGrid

_TICKS = 4


def draw_heat_map(name: str, grid: StoredGrid, *, fields: Mapping[str, NDArray[Any]]) -> bytes:
    """Draw one grid: for each pair of measures, how many cells behind one another hold successes.

    Places where only failures are kept are grey. A grid of one measure is drawn as a row of its
    elites' objectives.

    Args:
        name: The descriptor.
        grid: Its grid.
        fields: The archive's columns, `success` among them.

    Returns:
        A PNG file.
    """
    if len(grid.spec.dims) == 1:
        return _draw_row(name, grid, fields=fields)
    pairs = list(combinations(range(len(grid.spec.dims)), 2))
    columns = min(len(pairs), 3)
    rows = -(-len(pairs) // columns)
    figure = new_panels(4.4, 3.8, rows=rows, columns=columns)
    success = fields["success"][grid.elites]
    figure.suptitle(_title(name, grid, success))
    panels = figure.subplots(rows, columns, squeeze=False).ravel()
    for panel in panels[len(pairs) :]:
        panel.set_axis_off()
    for panel, pair in zip(panels, pairs, strict=False):
        _draw_pair(panel, grid, success, pair=pair)
    return png(figure)


def _title(name: str, grid: StoredGrid, success: NDArray[np.bool_]) -> str:
    return (
        f"{name}: {len(grid.cells)} of {int(np.prod(grid.spec.dims))} cells, "
        f"{int(success.sum())} with a success"
    )


def _draw_row(name: str, grid: StoredGrid, *, fields: Mapping[str, NDArray[Any]]) -> bytes:
    figure = new_figure(7.4, 4.2)
    success = fields["success"][grid.elites]
    figure.suptitle(_title(name, grid, success))
    axes = figure.subplots()
    ((low, high),) = grid.spec.ranges
    place = low + (grid.cells + 0.5) * (high - low) / grid.spec.dims[0]
    objective = fields["objective"][grid.elites]
    axes.scatter(place[~success], objective[~success], s=14, color=FAILURE_COLOR, label="failures")
    axes.scatter(place[success], objective[success], s=14, color="C0", label="successes")
    axes.set_xlim(low, high)
    axes.set_xlabel("measure 0")
    axes.set_ylabel("objective")
    axes.grid(alpha=0.3)
    axes.legend(loc="best")
    return png(figure)


def _draw_pair(
    axes: Axes, grid: StoredGrid, success: NDArray[np.bool_], *, pair: tuple[int, int]
) -> None:
    index = np.unravel_index(grid.cells, grid.spec.dims)
    shape = (grid.spec.dims[pair[0]], grid.spec.dims[pair[1]])
    filled, successes = np.zeros(shape), np.zeros(shape)
    np.add.at(filled, (index[pair[0]], index[pair[1]]), 1)
    np.add.at(successes, (index[pair[0]], index[pair[1]]), success)
    (left, right), (bottom, top) = (grid.spec.ranges[axis] for axis in pair)
    extent = (left, right, bottom, top)
    failures = np.ma.masked_where((filled == 0) | (successes > 0), filled)
    axes.imshow(
        failures.T,
        origin="lower",
        extent=extent,
        aspect="auto",
        cmap=ListedColormap([FAILURE_COLOR]),
        interpolation="nearest",
    )
    image = axes.imshow(
        np.ma.masked_equal(successes, 0).T,
        origin="lower",
        extent=extent,
        aspect="auto",
        cmap=SUCCESS_COLORS,
        vmin=0,
        interpolation="nearest",
    )
    axes.set_xlabel(f"measure {pair[0]}")
    axes.set_ylabel(f"measure {pair[1]}")
    # Most of the time to draw a picture goes into its ticks.
    axes.locator_params(nbins=_TICKS)
    if successes.any():
        whole = MaxNLocator(_TICKS, integer=True)
        axes.figure.colorbar(image, ax=axes, label="cells with a success", ticks=whole)
