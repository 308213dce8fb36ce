"""How the methods went: medians and interquartile ranges over evaluations."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from benchmarks.tables.cell_figures import CellFigures
from benchmarks.tables.results import Results
from lqd_search.pictures.figure import new_figure

Style = str | tuple[int, tuple[int, ...]]
"""How a line is dashed, as Matplotlib takes it."""

_PANELS = (
    ("success_archive_size", "final archive: successes"),
    ("ground_truth_cells", "final archive: ground-truth cells"),
    ("outcomes", "whole run: distinct successes"),
    ("outcome_cells", "whole run: ground-truth cells"),
)
# With gaps, so that of curves that coincide all are seen.
_STYLES: tuple[Style, ...] = ("-", "--", "-.", ":", (0, (6, 2, 1, 2, 1, 2)), (0, (2, 3)))


def draw_curves(results: Results, task: str) -> Figure:
    """Draw a task's figures over evaluations: each method's median, and a band to the quartiles.

    The archive of `ours` begins anew with each short run of the fitness exploration, and is
    rebuilt at its end; what counts is how it ends.

    Args:
        results: The finished cells.
        task: Short name of the task.
    """
    figure = new_figure(11.0, 7.6)
    figure.suptitle(f"{task}: median and interquartile range over seeds")
    panels = figure.subplots(2, 2, sharex=True).flat
    for axes, (column, title) in zip(panels, _PANELS, strict=True):
        axes.set_title(title)
        for i, method in enumerate(results.study.methods):
            cells = results.group(task, method)
            if cells:
                label = f"{method} ({len(cells)})"
                _draw(axes, cells, column, label=label, color=f"C{i}", style=_STYLES[i])
        axes.set_ylim(bottom=0.0)
        axes.grid(alpha=0.3)
        axes.set_xlabel("evaluations")
    handles, labels = panels[0].get_legend_handles_labels()
    if handles:
        figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))
    return figure


def _draw(
    axes: Axes, cells: list[CellFigures], column: str, *, label: str, color: str, style: Style
) -> None:
    low, median, high = np.percentile(
        [getattr(cell.curve, column) for cell in cells], [25, 50, 75], axis=0
    )
    evaluations = cells[0].curve.evaluations
    axes.plot(evaluations, median, label=label, color=color, linestyle=style)
    axes.fill_between(evaluations, low, high, color=color, alpha=0.2, linewidth=0.0)
