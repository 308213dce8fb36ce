"""What is measured in a cell: one number each."""

import math
from collections.abc import Callable
from dataclasses import dataclass

from benchmarks.tables.cell_figures import CellFigures, Verdicts

MeasureOf = Callable[[CellFigures], float]
"""Returns the number; NaN where it is not defined."""


@dataclass(frozen=True)
class Measure:
    """One number of a cell.

    Attributes:
        name: What it is called in the files.
        title: What it is called in tables and pictures.
        of: Returns it.
    """

    name: str
    title: str
    of: MeasureOf


def precision(verdicts: Verdicts) -> float:
    """Return which share of what the inferred condition approves the expert's does too."""
    return _ratio(verdicts.both, verdicts.both + verdicts.inferred_only)


def recall(verdicts: Verdicts) -> float:
    """Return which share of what the expert's condition approves the inferred one does too."""
    return _ratio(verdicts.both, verdicts.both + verdicts.expert_only)


def _inferred(score: Callable[[Verdicts], float], *, elites: bool) -> MeasureOf:
    def of(cell: CellFigures) -> float:
        if not cell.inferred:
            return math.nan
        return score(cell.elites if elites else cell.motions)

    return of


def _ratio(part: int, whole: int) -> float:
    return part / whole if whole else math.nan


SIZE = Measure("success_archive_size", "success archive size", lambda c: c.success_archive_size)
CELLS = Measure("ground_truth_cells", "ground-truth cells", lambda c: c.ground_truth_cells)
OUTCOMES = Measure("outcomes", "distinct successes", lambda c: c.outcomes)
OUTCOME_CELLS = Measure("outcome_cells", "ground-truth cells", lambda c: c.outcome_cells)
PRECISION = Measure("precision", "precision", _inferred(precision, elites=False))
RECALL = Measure("recall", "recall", _inferred(recall, elites=False))
ELITE_PRECISION = Measure(
    "elite_precision", "precision among elites", _inferred(precision, elites=True)
)
ELITE_RECALL = Measure("elite_recall", "recall among elites", _inferred(recall, elites=True))

COMPARED = (SIZE, CELLS)
"""What methods are compared by, both of the final archive."""

MEASURES = (
    SIZE,
    CELLS,
    OUTCOMES,
    OUTCOME_CELLS,
    PRECISION,
    RECALL,
    ELITE_PRECISION,
    ELITE_RECALL,
    Measure("archive_size", "distinct elites", lambda c: c.archive_size),
    Measure("ground_truth_outside", "elites outside the grid", lambda c: c.ground_truth_outside),
    Measure("outcomes_outside", "successes outside the grid", lambda c: c.outcomes_outside),
    Measure("valid", "valid motions", lambda c: c.valid),
    Measure("rejected", "rejected motions", lambda c: c.rejected),
    Measure("discarded", "discarded motions", lambda c: c.discarded),
    Measure("inferred_successes", "inferred successes", lambda c: c.inferred_successes),
    Measure("expert_successes", "expert's successes", lambda c: c.expert_successes),
    Measure("seconds", "seconds", lambda c: c.seconds),
)
"""All of them, as the long form has them."""

BY_NAME = {measure.name: measure for measure in MEASURES}
"""The same by name."""
