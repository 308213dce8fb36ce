"""The model's variance and the search's, as a table."""

import math

import numpy as np

from benchmarks.tables.ablation_study import CROSSINGS
from benchmarks.tables.markdown import markdown_table
from benchmarks.tables.measures import COMPARED, Measure
from benchmarks.tables.results import Results
from benchmarks.tables.spread import NOTHING
from benchmarks.tables.variance import Share, split_variance

SEED = 20_260_102
_HEAD = (
    *("task", "measure", "runs"),
    *("recordings' share [95 % interval]", "seeds' share", "share of the rest"),
)


def variance_table(results: Results) -> str:
    """Return how much of the variance of `ours` goes with recordings, with seeds, with the rest."""
    rows = [
        (task, measure.title, *_texts(results, task, measure))
        for task in results.study.tasks
        for measure in COMPARED
    ]
    return markdown_table(_HEAD, rows, words=2)


def _texts(results: Results, task: str, measure: Measure) -> tuple[str, ...]:
    crossing = CROSSINGS[results.study.scale]
    cells = crossing.cells(task)
    found = [measure.of(results.cells[cell]) for cell in cells if cell in results.cells]
    if len(found) < len(cells):
        return f"{len(found)} of {len(cells)}", NOTHING, NOTHING, NOTHING
    table = np.array(found, float).reshape(len(crossing.samples), len(crossing.seeds))
    variances = split_variance(table, rng=np.random.default_rng(SEED))
    shares = (variances.rows, variances.columns, variances.rest)
    return (str(len(cells)), *(_text(share) for share in shares))


def _text(share: Share) -> str:
    if math.isnan(share.share):
        return "nothing varies"
    return f"{share.share:.0%} [{share.low:.0%}, {share.high:.0%}]"
