"""Successes and coverage over evaluations."""

from collections.abc import Sequence
from itertools import pairwise

from matplotlib.axes import Axes

from lqd_search.pictures.figure import new_figure, png
from lqd_search.runs.metrics import Metrics


def draw_curves(metrics: Sequence[Metrics], *, title: str) -> bytes:
    """Draw how a run went, one point a generation.

    The archive's curves break where another archive's turn begins: each short run of the fitness
    exploration fills its own, and the one that is kept goes on in rebuilt grids. Of a method
    without grids there is no coverage to draw.

    Args:
        metrics: A row for each generation, in order.
        title: What stands above.

    Returns:
        A PNG file.
    """
    has_grids = any(row.coverage is not None for row in metrics)
    figure = new_figure(8.0, 6.0 if has_grids else 4.4)
    figure.suptitle(title)
    ratios = (2, 1) if has_grids else (1,)
    panels = figure.subplots(len(ratios), 1, sharex=True, height_ratios=ratios, squeeze=False)[:, 0]
    _draw(panels[0], metrics, "success_archive_size", label="expert's condition", color="C0")
    _draw(panels[0], metrics, "inferred_archive_size", label="inferred condition", color="C1")
    panels[0].set_ylabel("distinct successes in the archive")
    panels[0].legend(loc="upper left")
    if has_grids:
        _draw(panels[1], metrics, "coverage", label="coverage", color="C2")
        panels[1].set_ylabel("filled cells,\nmean over grids")
    panels[-1].set_xlabel("evaluations")
    for axes in panels:
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
