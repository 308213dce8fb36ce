"""The tables of one task and one kind of instances."""

from collections.abc import Mapping

import numpy as np

from benchmarks.instances.candidates import most_looked_at
from benchmarks.instances.declared import EXPERT, FILTERS, INFERRED, SIZES, TRIES
from benchmarks.instances.figures import (
    BEST_IN_HINDSIGHT,
    BEST_ON_THE_OTHER_HALF,
    HIGHEST_FITNESS,
    RANDOM,
    Figure,
    SomeMotion,
    Success,
)
from benchmarks.instances.results import Results
from benchmarks.instances.steered import shown
from benchmarks.instances.two_way import Rate
from benchmarks.tables.markdown import markdown_table
from benchmarks.tables.spread import NOTHING
from lqd_search.adaptation import SELECTORS

_TRIES_BY_SIZE = 5
_WHOLE = "whole"
_CONTROLS: Mapping[str, Figure] = {
    "the highest fitness": HIGHEST_FITNESS,
    "the best in hindsight": BEST_IN_HINDSIGHT,
    "the best on the other half": BEST_ON_THE_OTHER_HALF,
}


def kind_section(results: Results, task: str, kind: str) -> str:
    """Return the tables of one task and one kind of instances."""
    solvable, left_out = results.solvable(task, kind), results.left_out(task, kind)
    drawn = len(results.instances[task, kind])
    names = ", ".join(f"`{instance.name}`" for instance in left_out)
    head = (
        f"{len(solvable)} of {drawn} instances are solved by a motion of some run; the others are "
        f"left out: {names}."
        if left_out
        else f"All {drawn} instances are solved by a motion of some run."
    )
    if not solvable:
        return head
    return "\n\n".join(
        [
            head,
            archive_table(results, task, kind),
            "One fixed motion of those looked at solves the instance:",
            control_table(results, task, kind),
            "Success@k: one of the first k motions that are tried solves the instance.",
            success_table(results, task, kind),
            "Some motion of a random subset of the archive solves the instance, by its size:",
            size_table(results, task, kind),
            f"Success@{_TRIES_BY_SIZE}, choosing from a random subset of the archive, by its size:",
            success_size_table(results, task, kind),
        ]
    )


def archive_table(results: Results, task: str, kind: str) -> str:
    """Return what whole archives are worth."""
    methods = results.methods(task)
    head = ["method", "runs"]
    for by in FILTERS:
        of = _of_how_many(results, task, kind, by)
        head += [f"{by}: motions", "looked at", f"some motion{of} solves it"]
    rows = []
    for method in methods:
        row = [shown(method), str(len(results.runs(task, method)))]
        for by in FILTERS:
            figures = [run[0] for run in results.figures(task, kind, method, by)]
            rates = results.rates(task, kind, method, by)
            row += [
                f"{np.median([one.motions for one in figures]):,.0f}",
                f"{np.median([one.looked_at.motions for one in figures]):,.0f}",
                rates[SomeMotion()].text,
            ]
        rows.append(row)
    return markdown_table(head, rows, words=1)


def control_table(results: Results, task: str, kind: str) -> str:
    """Return what one fixed motion of each archive is worth: the control."""
    head = ["method", *(f"{by}: {called}" for by in FILTERS for called in _CONTROLS)]
    rows = []
    for method in results.methods(task):
        cells = [
            _text(results.rates(task, kind, method, by), figure)
            for by in FILTERS
            for figure in _CONTROLS.values()
        ]
        rows.append([shown(method), *cells])
    return markdown_table(head, rows, words=1)


def success_table(results: Results, task: str, kind: str) -> str:
    """Return what selectors make of whole archives, beside choosing at random."""
    head = ["method", "choice", *(f"{by}: @{k}" for by in FILTERS for k in TRIES)]
    rows = []
    for method in results.methods(task):
        for selector in (*SELECTORS, RANDOM):
            figures = [Success(selector, k) for k in TRIES]
            cells = [
                _text(results.rates(task, kind, method, by), figure)
                for by in (INFERRED, EXPERT)
                for figure in figures
            ]
            rows.append([shown(method), selector, *cells])
    return markdown_table(head, rows, words=2)


def size_table(results: Results, task: str, kind: str) -> str:
    """Return the probability that some motion of a random subset solves an instance."""
    rows = []
    for method in results.methods(task):
        rates = results.rates(task, kind, method, INFERRED)
        cells = [_text(rates, SomeMotion(size)) for size in SIZES]
        rows.append([shown(method), *cells, rates[SomeMotion()].text])
    of = _of_how_many(results, task, kind, INFERRED)
    return _size_table(["method"], rows, whole=of.strip() or _WHOLE)


def success_size_table(results: Results, task: str, kind: str) -> str:
    """Return the success of a few tries, chosen from a random subset."""
    rows = []
    for method in results.methods(task):
        rates = results.rates(task, kind, method, INFERRED)
        for selector in SELECTORS:
            by_size = [Success(selector, _TRIES_BY_SIZE, size) for size in SIZES]
            cells = [_text(rates, figure) for figure in by_size]
            whole = rates[Success(selector, _TRIES_BY_SIZE)].text
            rows.append([shown(method), selector, *cells, whole])
    return _size_table(["method", "choice"], rows, whole=_WHOLE)


def _of_how_many(results: Results, task: str, kind: str, by: str) -> str:
    if not results.capped(task, kind, by, methods=results.methods(task)):
        return ""
    return f" of at most {most_looked_at(results.cap):,} looked at"


def _size_table(words: list[str], rows: list[list[str]], *, whole: str) -> str:
    head = [*words, *(f"{size:,}" for size in SIZES), whole]
    # Sizes that no archive has are no columns.
    kept = [
        i
        for i in range(len(head))
        if not len(words) <= i < len(head) - 1 or any(row[i] != NOTHING for row in rows)
    ]
    shown = [[row[i] for i in kept] for row in rows]
    return markdown_table([head[i] for i in kept], shown, words=len(words))


def _text(rates: Mapping[Figure, Rate], figure: Figure) -> str:
    return rates[figure].text if figure in rates else NOTHING
