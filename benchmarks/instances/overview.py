"""The first tables of the report: all tasks and kinds of instances at one glance."""

from benchmarks.instances.declared import INFERRED
from benchmarks.instances.figures import (
    BEST_IN_HINDSIGHT,
    BEST_ON_THE_OTHER_HALF,
    Figure,
    SomeMotion,
    Success,
)
from benchmarks.instances.percent import percent
from benchmarks.instances.results import Results
from benchmarks.instances.steered import shown
from benchmarks.tables.markdown import markdown_table
from benchmarks.tables.spread import NOTHING
from lqd_envs import get_task

_FIGURES: dict[str, Figure] = {
    "Some motion of the archive solves the instance:": SomeMotion(),
    "One fixed motion, the best one in hindsight, solves it:": BEST_IN_HINDSIGHT,
    "One fixed motion, the best one on the other half of the instances, solves it:": (
        BEST_ON_THE_OTHER_HALF
    ),
    "One of the first 5 motions that `diverse` tries solves it:": Success("diverse", 5),
    "One of 5 motions that are chosen at random solves it:": Success("random", 5),
    "One of 20 motions that are chosen at random solves it:": Success("random", 20),
}

_BOUNDS = (SomeMotion(), BEST_IN_HINDSIGHT)
"""Figures that are lower bounds where not all motions were looked at."""


def overview(results: Results) -> str:
    """Return a table for each of the main figures: a row for each task and kind of instances.

    They are those of the archives that the inferred condition approves; only means have intervals.
    """
    parts = [
        "Of the motions that the inferred condition approves; brackets are the intervals of "
        "the means, in which each task and kind counts as much as another. All other intervals, "
        "numbers of motions and figures stand below, task by task. Where not all motions of the "
        "archives were looked at, some motion of the archive, and the best one in hindsight, solve "
        "at least (≥) so many."
    ]
    for sentence, figure in _FIGURES.items():
        parts += [sentence, overview_table(results, figure)]
    return "\n\n".join(parts)


def overview_table(results: Results, figure: Figure) -> str:
    """Return one figure of all methods, task by task and kind by kind, and its mean."""
    methods = sorted({run.method for run in results.judgements})
    rows = [
        [get_task(task).name, kind, *(_cell(results, task, kind, one, figure) for one in methods)]
        for task, kind in results.instances
    ]
    rows.append(["mean", "", *(_mean(results, one, figure) for one in methods)])
    return markdown_table(["task", "kind", *map(shown, methods)], rows, words=2)


def _cell(results: Results, task: str, kind: str, method: str, figure: Figure) -> str:
    if method not in results.methods(task):
        return NOTHING
    rates = results.rates(task, kind, method, INFERRED)
    if figure not in rates:
        return NOTHING
    text = percent(rates[figure].value)
    return _at_least(text) if _is_bound(results, task, kind, method, figure) else text


def _mean(results: Results, method: str, figure: Figure) -> str:
    """Return the mean over tasks and kinds, where the figure is there for all of them."""
    rate = results.mean_rate(method, INFERRED, figure)
    if rate is None:
        return NOTHING
    lower = any(_is_bound(results, task, kind, method, figure) for task, kind in results.instances)
    return _at_least(rate.text) if lower else rate.text


def _is_bound(results: Results, task: str, kind: str, method: str, figure: Figure) -> bool:
    """Return whether a figure might be larger if more motions had been looked at."""
    return (
        figure in _BOUNDS
        and results.rates(task, kind, method, INFERRED)[figure].value < 1.0
        and results.capped(task, kind, INFERRED, methods=[method])
    )


def _at_least(text: str) -> str:
    return text if text.startswith(">") else f"≥ {text.replace('< 1%', '0%', 1)}"
