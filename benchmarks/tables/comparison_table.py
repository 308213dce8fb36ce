"""The comparisons that were declared, as a table."""

import math
from collections.abc import Sequence

from benchmarks.tables.cell_figures import CellFigures
from benchmarks.tables.comparison import Comparison, Hypothesis, smallest_p
from benchmarks.tables.markdown import markdown_table
from benchmarks.tables.measures import BY_NAME, Measure
from benchmarks.tables.results import Results
from benchmarks.tables.spread import NOTHING

_INTERVALS = (
    "The intervals are percentile bootstraps over the seeds, too narrow with so few; where every "
    "run of the one is beyond every run of the other they have no width at all. Seeds that share "
    "a recording share what the model wrote: tests and intervals speak for these recordings, and "
    "say little of other replies."
)
_BY_CAPACITY = (
    "A comparison is decided *by capacity* where every archive of the one holds more successes, or "
    "fills more cells, than an archive of the other has room for elites, whatever it finds."
)


def comparison_section(results: Results) -> str:
    """Return the table of the comparisons, and what can be read from it with so many seeds."""
    family, found = results.study.family, results.comparisons()
    n = len(results.study.seeds)
    reachable = min(1.0, smallest_p(n) * len(family))
    reach = (
        f"{len(found)} of the {len(family)} declared comparisons are complete. *p* is that of a "
        "two-sided Mann-Whitney U test, exact unless something else is said; *p, adjusted* is "
        "corrected by Holm's procedure for the whole family, in which a comparison that is missing "
        "counts as p = 1. A12 is the probability that a run of the first has the larger value, a "
        "tie counting half. With "
        f"{n} {'seed' if n == 1 else 'seeds'} against {n} the smallest p value that can be is "
        f"{_p(smallest_p(n))}, and the smallest adjusted one {_p(reachable)}"
    )
    if reachable > 0.05:
        reach += (
            ": at this scale no comparison can be significant at 5 %, and only the effect sizes "
            "say something"
        )
    return "\n\n".join([f"{reach}.", _INTERVALS, _BY_CAPACITY, _table(results, found)])


def _table(results: Results, found: Sequence[Comparison]) -> str:
    by_hypothesis = {comparison.hypothesis: comparison for comparison in found}
    head = ("task", "measure", "compared", "A12 [95 % interval]", "p", "p, adjusted", "by capacity")
    rows = [
        (
            hypothesis.task,
            BY_NAME[hypothesis.measure].title,
            f"{hypothesis.one} : {hypothesis.other}",
            *_texts(by_hypothesis.get(hypothesis)),
            _by_capacity(results, hypothesis) if hypothesis in by_hypothesis else NOTHING,
        )
        for hypothesis in results.study.family
    ]
    return markdown_table(head, rows, words=3)


def _by_capacity(results: Results, hypothesis: Hypothesis) -> str:
    measure = BY_NAME[hypothesis.measure]
    task, methods = hypothesis.task, (hypothesis.one, hypothesis.other)
    one, other = (results.group(task, method) for method in methods)
    decided = _overflows(one, other, measure) or _overflows(other, one, measure)
    return "yes" if decided else "no"


def _overflows(one: Sequence[CellFigures], other: Sequence[CellFigures], measure: Measure) -> bool:
    """Return whether the least of the one is more than the other has room for.

    Each elite is one success at most, and fills one cell at most.
    """
    return min(map(measure.of, one)) > max(cell.capacity for cell in other)


def _texts(comparison: Comparison | None) -> tuple[str, str, str]:
    if comparison is None:
        return NOTHING, NOTHING, NOTHING
    effect, test = comparison.effect, comparison.test
    interval = "" if math.isnan(effect.low) else f" [{effect.low:.2f}, {effect.high:.2f}]"
    approximate = "" if test.exact else " (normal approximation)"
    return f"{effect.a12:.2f}{interval}", _p(test.p) + approximate, _p(comparison.adjusted)


def _p(p: float) -> str:
    return f"{p:.1e}" if p < 1e-3 else f"{p:.3f}"
