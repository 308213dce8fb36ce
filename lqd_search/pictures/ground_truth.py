"""The ground-truth grid: which of its cells a success archive fills."""

from itertools import combinations

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from lqd_envs import GroundTruth
from lqd_search.pictures.figure import SUCCESS_COLORS, new_figure, png
from lqd_search.runs.success_archive import SuccessArchive


def draw_ground_truth(ground_truth: GroundTruth, successes: SuccessArchive) -> bytes:
    """Draw how many successes each cell of the ground-truth grid holds, by the expert's word.

    One dimension is drawn as bars, more as one picture for each pair of them, summed over the
    others.

    Args:
        ground_truth: The task's grid.
        successes: What fills it.

    Returns:
        A PNG file.
    """
    counts = np.zeros(ground_truth.dims, dtype=np.int64)
    counts.flat[successes.cells] = successes.counts
    pairs = list(combinations(range(counts.ndim), 2))
    figure = new_figure(4.6 * max(len(pairs), 1.6), 4.2)
    figure.suptitle(
        f"ground truth: {len(successes.cells)} of {counts.size} cells filled by "
        f"{successes.size} successes"
    )
    if not pairs:
        _draw_bars(figure.subplots(), counts, ground_truth)
    for axes, pair in zip(
        figure.subplots(1, len(pairs), squeeze=False)[0] if pairs else (), pairs, strict=True
    ):
        _draw_pair(axes, counts, ground_truth, pair=pair)
    return png(figure)


def _draw_bars(axes: Axes, counts: NDArray[np.int64], ground_truth: GroundTruth) -> None:
    low, high = ground_truth.ranges[0]
    axes.stairs(counts, np.linspace(low, high, len(counts) + 1), fill=True, color="C0")
    axes.set_xlim(low, high)
    axes.set_xlabel(ground_truth.names[0])
    axes.set_ylabel("successes in the cell")
    axes.grid(alpha=0.3)


def _draw_pair(
    axes: Axes, counts: NDArray[np.int64], ground_truth: GroundTruth, *, pair: tuple[int, int]
) -> None:
    others = tuple(axis for axis in range(counts.ndim) if axis not in pair)
    seen = counts.sum(axis=others)
    (left, right), (bottom, top) = (ground_truth.ranges[axis] for axis in pair)
    image = axes.imshow(
        np.ma.masked_equal(seen, 0).T,
        origin="lower",
        extent=(left, right, bottom, top),
        aspect="auto",
        cmap=SUCCESS_COLORS,
        vmin=0,
        interpolation="nearest",
    )
    axes.set_xlabel(ground_truth.names[pair[0]])
    axes.set_ylabel(ground_truth.names[pair[1]])
    axes.figure.colorbar(image, ax=axes, label="successes")
