"""What an archive is worth, by its size."""

from collections.abc import Callable, Mapping

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Picture

from benchmarks.instances.declared import INFERRED
from benchmarks.instances.figures import Figure, FixedMotion, SomeMotion, Success
from benchmarks.instances.results import Results
from benchmarks.instances.steered import shown
from benchmarks.instances.two_way import Rate
from lqd_search.adaptation import SELECTORS
from lqd_search.pictures.figure import new_figure

_TRIES = 5
_MARKERS = "osD^vP"
_STYLE_OF: Mapping[str, str] = {"": "-", **dict(zip(SELECTORS, ("-", "--"), strict=True))}
"""Of each selector, and of none."""

_OfSize = Callable[[int | None], Figure]


def draw_sizes(results: Results, task: str) -> Picture:
    """Draw the rates of a task's archives over the size of random subsets, a panel for each kind.

    Above, the probability that some motion solves an instance; below, success@5 by each selector.
    The last point of a line is the whole archive, at its median size. Bands are the intervals.

    Args:
        results: The judgements.
        task: Id of the task.
    """
    kinds = results.kinds
    picture = new_figure(3.4 * len(kinds) + 0.6, 7.0)
    picture.suptitle(f"{task}: archives of motions that the inferred condition approves")
    panels = picture.subplots(2, len(kinds), sharey=True, squeeze=False)
    for column, kind in enumerate(kinds):
        panels[0, column].set_title(kind)
        _draw_lines(panels[0, column], results, task, kind, {"": SomeMotion})
        choices: dict[str, _OfSize] = {name: _success(name) for name in SELECTORS}
        _draw_lines(panels[1, column], results, task, kind, choices)
        panels[1, column].set_xlabel("motions")
    panels[0, 0].set_ylabel("some motion solves the instance")
    panels[1, 0].set_ylabel(f"success@{_TRIES}")
    for axes in panels.flat:
        axes.set_xscale("log")
        axes.set_ylim(-0.03, 1.03)
        axes.grid(alpha=0.3)
    handles: dict[str, matplotlib.artist.Artist] = {}
    for axes in panels.flat:
        for handle, label in zip(*axes.get_legend_handles_labels(), strict=True):
            handles.setdefault(label, handle)
    if handles:
        picture.legend(handles.values(), handles, loc="outside lower center", ncols=4)
    return picture


def _success(selector: str) -> _OfSize:
    return lambda size: Success(selector, _TRIES, size)


def _draw_lines(
    axes: Axes, results: Results, task: str, kind: str, choices: Mapping[str, _OfSize]
) -> None:
    for i, method in enumerate(results.methods(task)):
        rates = results.rates(task, kind, method, INFERRED)
        if not rates:
            continue
        runs = results.figures(task, kind, method, INFERRED)
        for choice, of_size in choices.items():
            # A selector chooses from all motions; of them, some were looked at.
            sizes = [run[0].motions if choice else run[0].looked_at.motions for run in runs]
            whole = max(1.0, float(np.median(sizes)))
            points = _points(rates, of_size, whole=whole)
            label = f"{shown(method)}, {choice}" if choice else shown(method)
            _draw(
                axes, points, label, color=f"C{i}", marker=_MARKERS[i % 6], style=_STYLE_OF[choice]
            )


def _points(
    rates: Mapping[Figure, Rate], of_size: _OfSize, *, whole: float
) -> list[tuple[float, Rate]]:
    subsets = [figure for figure in rates if not isinstance(figure, FixedMotion)]
    sizes = sorted({figure.size for figure in subsets if figure.size is not None})
    points: list[tuple[float, Rate]] = [
        (size, rates[of_size(size)]) for size in sizes if size < whole and of_size(size) in rates
    ]
    return [*points, (whole, rates[of_size(None)])]


def _draw(
    axes: Axes,
    points: list[tuple[float, Rate]],
    label: str,
    *,
    color: str,
    marker: str,
    style: str,
) -> None:
    sizes = [size for size, _ in points]
    rates = [rate for _, rate in points]
    axes.plot(sizes, [r.value for r in rates], style, label=label, color=color, marker=marker, ms=4)
    low, high = [r.low for r in rates], [r.high for r in rates]
    if not np.isnan(low).any():
        axes.fill_between(sizes, low, high, color=color, alpha=0.12, linewidth=0.0)
