"""The tables of a task's figures, and of what the inferred success condition is worth."""

import numpy as np

from benchmarks.tables.markdown import markdown_table
from benchmarks.tables.measures import (
    CELLS,
    ELITE_PRECISION,
    ELITE_RECALL,
    OUTCOME_CELLS,
    OUTCOMES,
    PRECISION,
    RECALL,
    SIZE,
    Measure,
)
from benchmarks.tables.paper_figures import PaperFigures
from benchmarks.tables.results import Results
from benchmarks.tables.spread import NOTHING

_CAPACITY = "elites it can hold, median"
_JUDGED_ONLY = (
    "Over all valid motions of a run, and over the distinct elites of its final archive. `random` "
    "and `ga` are not steered by the condition: it only judges what they come by. The condition "
    "of `direct` is the one that the model wrote together with all else, that of `mesh` the one "
    "that it wrote on its own: they are two conditions, and not two searches with the same. What "
    "recall comes to depends on which motions a search makes: rows of different methods do not "
    "tell which condition is better, and those of `random`, which no condition steers, are the "
    "ones to compare tasks by."
)


def final_archive_table(results: Results, task: str, *, paper: PaperFigures) -> str:
    """Return the figures of the final archives, the paper's own beside them if there are any."""
    compared = any(figure.task == task for figure in paper.figures)
    head = ["method", "seeds"]
    for measure in (SIZE, CELLS):
        head += [f"{measure.title}, mean ± std", *(["the paper's"] * compared), "median [IQR]"]
    rows = []
    for method in results.study.methods:
        row = [method, _seeds(results, task, method)]
        for measure in (SIZE, CELLS):
            mean, median = _texts(results, task, method, measure, digits=1)
            row += [mean, *([paper.text(task, method, measure.name)] * compared), median]
        rows.append([*row, _capacity(results, task, method)])
    table = markdown_table([*head, _CAPACITY], rows, words=1)
    remarks = [] if compared else ["The paper's own figures are not at hand."]
    remarks += [
        f"{remark.text} ({remark.source}.)" for remark in paper.remarks if remark.task == task
    ]
    return "\n\n".join([table, *remarks])


def outcome_table(results: Results, task: str) -> str:
    """Return the figures of the outcome archives: every distinct success of the whole run."""
    head, rows = _plain_rows(results, task, (OUTCOMES, OUTCOME_CELLS))
    return markdown_table(head, rows, words=1)


def variant_table(results: Results, task: str) -> str:
    """Return the figures of the final archives alone, for what the paper has no figures of."""
    head, rows = _plain_rows(results, task, (SIZE, CELLS))
    held = [[*row, _capacity(results, task, row[0])] for row in rows]
    return markdown_table([*head, _CAPACITY], held, words=1)


def condition_table(results: Results) -> str:
    """Return precision and recall of the inferred success condition, judged by the expert's."""
    measures = (PRECISION, RECALL, ELITE_PRECISION, ELITE_RECALL)
    head = ["task", "method", "condition", "runs", "expert's successes, median"]
    for measure in measures:
        head += [f"{measure.title}, mean ± std", "median [IQR]"]
    rows = []
    for task in results.study.tasks:
        for method in results.study.methods:
            cells = [cell for cell in results.group(task, method) if cell.inferred]
            if cells:
                texts = [_texts(results, task, method, m, digits=3) for m in measures]
                successes = np.median([cell.expert_successes for cell in cells])
                row = [task, method, cells[0].steering, str(len(cells)), f"{successes:,.0f}"]
                rows.append([*row, *(text for pair in texts for text in pair)])
    return f"{_JUDGED_ONLY}\n\n{markdown_table(head, rows, words=3)}"


def _plain_rows(
    results: Results, task: str, measures: tuple[Measure, ...]
) -> tuple[list[str], list[list[str]]]:
    head = ["method", "seeds"]
    for measure in measures:
        head += [f"{measure.title}, mean ± std", "median [IQR]"]
    rows = [
        [
            method,
            _seeds(results, task, method),
            *(
                text
                for measure in measures
                for text in _texts(results, task, method, measure, digits=1)
            ),
        ]
        for method in results.study.methods
    ]
    return head, rows


def _texts(
    results: Results, task: str, method: str, measure: Measure, *, digits: int
) -> tuple[str, str]:
    spread = results.spread(task, method, measure)
    if spread is None:
        return NOTHING, NOTHING
    cells = len(results.group(task, method))
    # Of a run in which nothing was approved, precision or recall is not defined.
    defined = "" if spread.n == cells else f" ({spread.n} of {cells})"
    return spread.mean_text(digits) + defined, spread.median_text(digits)


def _capacity(results: Results, task: str, method: str) -> str:
    held = [cell.capacity for cell in results.group(task, method)]
    return f"{np.median(held):,.0f}" if held else NOTHING


def _seeds(results: Results, task: str, method: str) -> str:
    finished, declared = len(results.group(task, method)), len(results.study.seeds)
    return str(finished) if finished == declared else f"{finished} of {declared}"
