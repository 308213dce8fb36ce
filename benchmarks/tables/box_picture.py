"""How the methods ended: boxes over the seeds, and each seed as a point."""

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from benchmarks.tables.measures import CELLS, OUTCOME_CELLS, OUTCOMES, SIZE, Measure
from benchmarks.tables.results import Results
from lqd_search.pictures.figure import new_figure

_PANELS = (
    ("final archive: ", SIZE),
    ("final archive: ", CELLS),
    ("whole run: ", OUTCOMES),
    ("whole run: ", OUTCOME_CELLS),
)
_WIDTH = 0.6


def draw_boxes(results: Results, task: str) -> Figure:
    """Draw a task's figures as boxes from quartile to quartile, with whiskers to the extremes.

    Args:
        results: The finished cells.
        task: Short name of the task.
    """
    figure = new_figure(11.0, 7.6)
    figure.suptitle(f"{task}: a point for each finished seed, boxes from quartile to quartile")
    panels = figure.subplots(2, 2, sharex=True).flat
    for axes, (where, measure) in zip(panels, _PANELS, strict=True):
        axes.set_title(where + measure.title)
        _draw(axes, results, task, measure)
        axes.set_ylim(bottom=0.0)
        axes.grid(alpha=0.3, axis="y")
    return figure


def _draw(axes: Axes, results: Results, task: str, measure: Measure) -> None:
    methods, labels = results.study.methods, []
    for place, method in enumerate(methods):
        values = [measure.of(cell) for cell in results.group(task, method)]
        if values:
            axes.boxplot(values, positions=[place], widths=_WIDTH, whis=(0, 100), showfliers=False)
        # Beside each other in the order of the seeds, so that equal ones are seen.
        n = len(values)
        labels.append(f"{method} ({n})")
        places = [place + _WIDTH * ((i + 0.5) / n - 0.5) for i in range(n)]
        axes.plot(places, values, ".", color=f"C{place}", alpha=0.8)
    axes.set_xticks(range(len(methods)), labels, rotation=20)
    axes.set_xlim(-0.6, len(methods) - 0.4)
