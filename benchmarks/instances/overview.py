"""The first tables of the report: all tasks and kinds of instances at one glance."""

from benchmarks.instances.declared import INFERRED
from benchmarks.instances.figures import BEST_ON_THE_OTHERS, Figure, SomeMotion, Success
from benchmarks.instances.results import Results
from benchmarks.instances.steered import shown
from benchmarks.tables.markdown import markdown_table
from benchmarks.tables.spread import NOTHING
from lqd_envs import get_task

_NEARLY_ALL = 0.995
_FIGURES: dict[str, Figure] = {
    "Some motion of the archive solves the instance:": SomeMotion(),
    "One fixed motion, the best one on the other instances, solves it:": BEST_ON_THE_OTHERS,
    "One of the first 5 motions that `diverse` tries solves it:": Success("diverse", 5),
    "One of 5 motions that are chosen at random solves it:": Success("random", 5),
    "One of 20 motions that are chosen at random solves it:": Success("random", 20),
}


def overview(results: Results) -> str:
    """Return a table for each of the main figures: a row for each task and kind of instances.

    They are those of the archives that the inferred condition approves, without their intervals.
    """
    parts = [
        "Of the motions that the inferred condition approves; intervals, numbers of motions and "
        "all other figures stand below, task by task. Where not all motions of the archives were "
        "looked at, some motion of the archive solves at least (≥) so many."
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
    value = _value(results, task, kind, method, figure)
    lower = figure == SomeMotion() and results.capped(task, kind, INFERRED, methods=[method])
    bound = "≥ " if lower and value is not None and value < _NEARLY_ALL else ""
    return bound + _text(value)


def _mean(results: Results, method: str, figure: Figure) -> str:
    """Return the mean over tasks and kinds, where the figure is there for all of them."""
    values = [_value(results, task, kind, method, figure) for task, kind in results.instances]
    known = [value for value in values if value is not None]
    return _text(sum(known) / len(known) if len(known) == len(values) else None)


def _value(results: Results, task: str, kind: str, method: str, figure: Figure) -> float | None:
    if method not in results.methods(task):
        return None
    rates = results.rates(task, kind, method, INFERRED)
    return rates[figure].value if figure in rates else None


def _text(value: float | None) -> str:
    if value is None:
        return NOTHING
    # What is rounded to all is not all.
    return "> 99%" if _NEARLY_ALL <= value < 1.0 else f"{value:.0%}"
