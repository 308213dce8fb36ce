"""The first tables of the report: all tasks and kinds of instances at one glance."""

from benchmarks.instances.declared import INFERRED
from benchmarks.instances.figures import BEST_ON_THE_OTHERS, Figure, SomeMotion, Success
from benchmarks.instances.results import Results
from benchmarks.instances.steered import shown
from benchmarks.tables.markdown import markdown_table
from benchmarks.tables.spread import NOTHING
from lqd_envs import get_task

_FIGURES: dict[str, Figure] = {
    "Some motion of the archive solves the instance:": SomeMotion(),
    "One fixed motion, the best one on the other instances, solves it:": BEST_ON_THE_OTHERS,
    "One of the first 5 motions that `diverse` tries solves it:": Success("diverse", 5),
    "One of 5 motions that are chosen at random solves it:": Success("random", 5),
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
    """Return one figure of all methods, task by task and kind by kind."""
    methods = sorted({run.method for run in results.judgements})
    rows = [
        [get_task(task).name, kind, *(_cell(results, task, kind, one, figure) for one in methods)]
        for task, kind in results.instances
    ]
    return markdown_table(["task", "kind", *map(shown, methods)], rows, words=2)


def _cell(results: Results, task: str, kind: str, method: str, figure: Figure) -> str:
    if method not in results.methods(task):
        return NOTHING
    rates = results.rates(task, kind, method, INFERRED)
    if figure not in rates:
        return NOTHING
    value = rates[figure].value
    if 0.995 <= value < 1.0:
        return "> 99%"
    capped = results.capped(task, kind, INFERRED, methods=[method])
    bound = "≥ " if figure == SomeMotion() and capped and value < 1.0 else ""
    return f"{bound}{value:.0%}"
