"""The comparisons that were declared, as a table."""

import math
from collections.abc import Sequence

from benchmarks.tables.comparison import Comparison, Hypothesis, smallest_p
from benchmarks.tables.markdown import markdown_table
from benchmarks.tables.measures import BY_NAME
from benchmarks.tables.results import Results
from benchmarks.tables.spread import NOTHING


def comparison_section(results: Results) -> str:
    """Return the table of the comparisons, and what can be read from it with so many seeds."""
    family, found = results.study.family, results.comparisons()
    n = len(results.study.seeds)
    reachable = min(1.0, smallest_p(n) * len(family))
    reach = (
        f"{len(found)} of the {len(family)} declared comparisons are complete. Each p value is "
        "two-sided (Mann-Whitney U) and adjusted by Holm's procedure for the whole family, in "
        "which a comparison that is missing counts as p = 1. With "
        f"{n} {'seed' if n == 1 else 'seeds'} against {n} the smallest p value that can be is "
        f"{_p(smallest_p(n))}, and the smallest adjusted one {_p(reachable)}"
    )
    if reachable > 0.05:
        reach += (
            ": at this scale no comparison can be significant at 5 %, and only the effect sizes "
            "and their intervals say something"
        )
    return f"{reach}.\n\n{_table(family, found)}"


def _table(family: Sequence[Hypothesis], found: Sequence[Comparison]) -> str:
    by_hypothesis = {comparison.hypothesis: comparison for comparison in found}
    head = ("task", "measure", "compared", "A12 [95 % interval]", "p", "p, adjusted")
    rows = [
        (
            hypothesis.task,
            BY_NAME[hypothesis.measure].title,
            f"{hypothesis.one} : {hypothesis.other}",
            *_texts(by_hypothesis.get(hypothesis)),
        )
        for hypothesis in family
    ]
    return markdown_table(head, rows, words=3)


def _texts(comparison: Comparison | None) -> tuple[str, str, str]:
    if comparison is None:
        return NOTHING, NOTHING, NOTHING
    effect, test = comparison.effect, comparison.test
    interval = "" if math.isnan(effect.low) else f" [{effect.low:.2f}, {effect.high:.2f}]"
    approximate = "" if test.exact else " (normal approximation)"
    return f"{effect.a12:.2f}{interval}", _p(test.p) + approximate, _p(comparison.adjusted)


def _p(p: float) -> str:
    return f"{p:.1e}" if p < 1e-3 else f"{p:.3f}"
