"""The model's variance and the search's, as a table."""

import math

import numpy as np

from benchmarks.tables.ablation_study import CROSSINGS
from benchmarks.tables.markdown import markdown_table
from benchmarks.tables.measures import COMPARED, Measure
from benchmarks.tables.results import Results
from benchmarks.tables.spread import NOTHING, Spread
from benchmarks.tables.variance import Share, split_variance

SEED = 20_260_102
_HEAD = (
    *("task", "measure", "runs", "mean ± std", "the model's share [95 % interval]"),
    *("the search's share", "the seeds' alone", "the rest"),
)
_WHAT = (
    "`ours` with each of the recordings and each of some seeds, one run of each pair. What goes "
    "with the recording is the model's share of the variance. All else is the search's, and has "
    "two parts: what goes with the seed whatever the recording, and the rest, which is what a "
    "seed does with one recording and not with another. The intervals suppose normal effects and "
    "are wide, as there are few recordings. Read the shares beside the standard deviation: where "
    "runs hardly differ, a share of it says nothing."
)


def variance_table(results: Results) -> str:
    """Return how much of the variance of `ours` goes with recordings, with seeds, with the rest."""
    rows = [
        (task, measure.title, *_texts(results, task, measure))
        for task in results.study.tasks
        for measure in COMPARED
    ]
    return f"{_WHAT}\n\n{markdown_table(_HEAD, rows, words=2)}"


def _texts(results: Results, task: str, measure: Measure) -> tuple[str, ...]:
    crossing = CROSSINGS[results.study.scale]
    cells = crossing.cells(task)
    found = [measure.of(results.cells[cell]) for cell in cells if cell in results.cells]
    if len(found) < len(cells):
        return f"{len(found)} of {len(cells)}", *[NOTHING] * 5
    table = np.array(found, float).reshape(len(crossing.samples), len(crossing.seeds))
    spread = Spread.of(found)
    assert spread is not None
    variances = split_variance(table, rng=np.random.default_rng(SEED))
    shares = (variances.rows, variances.but_rows, variances.columns, variances.rest)
    return (str(len(cells)), spread.mean_text(), *(_text(share) for share in shares))


def _text(share: Share) -> str:
    if math.isnan(share.share):
        return "nothing varies"
    return f"{share.share:.0%} [{share.low:.0%}, {share.high:.0%}]"
