"""Successes and coverage over evaluations."""

from collections.abc import Sequence
from itertools import pairwise

from matplotlib.axes import Axes

from lqd_search.pictures.figure import new_figure, png
from lqd_search.runs.metrics import Metrics


def draw_curves(metrics: Sequence[Metrics], *, title: str) -> bytes:
    """Draw how a run went, one point a generation.

    The archive's curves break where another archive's turn begins: each short run of the fitness
    exploration fills its own, and the one that is kept goes on in rebuilt grids.

    Args:
        metrics: A row for each generation, in order.
        title: What stands above.

    Returns:
        A PNG file.
    """
    figure = new_figure(8.0, 6.0)
    sizes, coverage = figure.subplots(2, 1, sharex=True, height_ratios=(2, 1))
    figure.suptitle(title)
    _draw(sizes, metrics, "success_archive_size", label="expert's condition", color="C0")
    _draw(sizes, metrics, "inferred_archive_size", label="inferred condition", color="C1")
    sizes.set_ylabel("distinct successes in the archive")
    sizes.legend(loc="upper left")
    _draw(coverage, metrics, "coverage", label="coverage", color="C2")
    coverage.set_ylabel("filled cells,\nmean over grids")
    coverage.set_xlabel("evaluations")
    for axes in (sizes, coverage):
        axes.set_ylim(bottom=0.0)
        axes.grid(alpha=0.3)
        _mark_stages(axes, metrics)
    return png(figure)


def _stages(metrics: Sequence[Metrics]) -> list[list[Metrics]]:
    stages: list[list[Metrics]] = []
    for row in metrics:
        if stages and stages[-1][-1].stage == row.stage:
            stages[-1].append(row)
        else:
            stages.append([row])
    return stages


def _draw(axes: Axes, metrics: Sequence[Metrics], column: str, *, label: str, color: str) -> None:
    for i, stage in enumerate(_stages(metrics)):
        axes.plot(
            [row.evaluations for row in stage],
            [getattr(row, column) for row in stage],
            marker=".",
            color=color,
            label=label if i == 0 else None,
        )


def _mark_stages(axes: Axes, metrics: Sequence[Metrics]) -> None:
    for before, _ in pairwise(_stages(metrics)):
        axes.axvline(before[-1].evaluations, color="0.6", linewidth=0.8, linestyle=":")
