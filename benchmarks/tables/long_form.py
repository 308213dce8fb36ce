"""The figures in long form: a row for each cell and measure."""

import csv
import io

from benchmarks.tables.measures import MEASURES
from benchmarks.tables.results import Results

_HEAD = (
    *("scale", "task", "method", "seed", "sample", "role", "evaluations", "capacity", "commit"),
    *("measure", "value"),
)


def long_form(results: Results) -> str:
    """Return a CSV table; where a measure is not defined, its value is empty.

    The role of a cell is `compared`, or `crossed` where the comparisons do not rest on it.
    """
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(_HEAD)
    for cell, figures in sorted(results.cells.items()):
        role = "compared" if results.study.compares(cell) else "crossed"
        for measure in MEASURES:
            value = measure.of(figures)
            writer.writerow(
                (
                    results.study.scale,
                    *(cell.task, cell.method, cell.seed, cell.sample),
                    role,
                    *(figures.evaluations, figures.capacity, figures.commit),
                    measure.name,
                    # NaN alone is not equal to itself.
                    "" if value != value else value,
                )
            )
    return text.getvalue()
