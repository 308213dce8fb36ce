"""The curves of a report: figures over evaluations, a line for each run."""

from collections.abc import Sequence
from typing import TypedDict

from lqd_search.report.reported_run import ReportedRun
from lqd_search.runs.metrics import Metrics

FIGURES = {
    "success_archive_size": "successes in the archive (expert)",
    "inferred_archive_size": "successes in the archive (inferred)",
    "ground_truth_cells": "ground-truth cells of the archive",
    "coverage": "filled cells, mean over grids",
    "outcomes": "distinct successes of the whole run (expert)",
    "outcome_cells": "their ground-truth cells",
}
"""What is drawn: columns of `metrics.csv` and their titles."""


class Line(TypedDict):
    """One run's line; None breaks it."""

    run: int
    x: list[int | None]
    y: list[float | None]


class Curve(TypedDict):
    """One figure of all runs."""

    title: str
    lines: list[Line]


def curves_of(runs: Sequence[ReportedRun]) -> list[Curve]:
    """Return every figure over evaluations, a line for each run that has it.

    A line of an archive's figure breaks where another archive's turn begins: each short run of the
    fitness exploration fills its own, and the one that is kept goes on in rebuilt grids. Methods
    without grids have one turn only, whatever they call their stages.
    """
    return [
        {
            "title": title,
            "lines": [
                _line(run.metrics, column, run=i)
                for i, run in enumerate(runs)
                if any(getattr(row, column) is not None for row in run.metrics)
            ],
        }
        for column, title in FIGURES.items()
    ]


def _line(metrics: Sequence[Metrics], column: str, *, run: int) -> Line:
    breaks = not column.startswith("outcome") and any(row.coverage is not None for row in metrics)
    x: list[int | None] = []
    y: list[float | None] = []
    for before, row in zip([None, *metrics], metrics, strict=False):
        if breaks and before is not None and before.stage != row.stage:
            x.append(None)
            y.append(None)
        x.append(row.evaluations)
        y.append(getattr(row, column))
    return {"run": run, "x": x, "y": y}
