"""How a switch did beside `ours`, and the rule by which it pays."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.switches.switch_cell import OURS, SwitchCell
from benchmarks.tables.markdown import markdown_table
from benchmarks.tables.spread import NOTHING, Spread

# Never those of the benchmarks, which begin at 0; seed k uses the recorded sample k mod 5.
TUNING_SEEDS = (100, 101, 102, 103, 104)
TASKS = ("faucet", "drawer", "push", "grasp")
_PAYING_TASKS = 3


@dataclass(frozen=True)
class Gain:
    """How a switch did on one task beside `ours`, seed by seed.

    Attributes:
        task: Short name of the task.
        switches: Names of the switches.
        size: For each seed the ratio of the success archives' sizes, each plus 1.
        cells: For each seed the same ratio of their ground-truth cells.
        idle: Whether every run found what that of `ours` did: the switch had nothing to do.
    """

    task: str
    switches: str
    size: tuple[float, ...]
    cells: tuple[float, ...]
    idle: bool

    @property
    def verdict(self) -> str:
        """What stands in the table."""
        return "no effect" if self.idle else "yes" if self.pays else "no"

    @property
    def pays(self) -> bool:
        """Whether it counts as a gain, by the rule that was fixed before any cell was run.

        The median of one ratio is at least 1.05, and that of the other at least 0.95.
        """
        size, cells = np.median(self.size), np.median(self.cells)
        return bool(max(size, cells) >= 1.05 and min(size, cells) >= 0.95)


def gains(cells: Sequence[SwitchCell]) -> list[Gain]:
    """Compare each complete set of seeds with that of `ours` on the same task, by switch."""
    by_key = {(c.task, c.switches, c.seed): c for c in cells}
    found = []
    for switches, task in sorted({(c.switches, c.task) for c in cells if c.switches != OURS}):
        pairs = [
            (by_key.get((task, switches, seed)), by_key.get((task, OURS, seed)))
            for seed in TUNING_SEEDS
        ]
        complete = [(a, b) for a, b in pairs if a and b]
        if len(complete) == len(TUNING_SEEDS):
            found.append(
                Gain(
                    task,
                    switches,
                    tuple(
                        (a.success_archive_size + 1) / (b.success_archive_size + 1)
                        for a, b in complete
                    ),
                    tuple(
                        (a.ground_truth_cells + 1) / (b.ground_truth_cells + 1) for a, b in complete
                    ),
                    idle=all(a.found == b.found for a, b in complete),
                )
            )
    return found


def table(cells: Sequence[SwitchCell]) -> str:
    """Return the gains as a Markdown table: medians, and interquartile ranges in brackets."""
    head = ("switch", "task", "success archive, ratio", "ground-truth cells, ratio", "pays")
    rows = [
        (gain.switches, gain.task, _spread(gain.size), _spread(gain.cells), gain.verdict)
        for gain in gains(cells)
    ]
    return markdown_table(head, rows, words=2)


def _spread(ratios: Sequence[float]) -> str:
    spread = Spread.of(ratios)
    return NOTHING if spread is None else spread.median_text(2)


def given_up(name: str, cells: Sequence[SwitchCell]) -> bool:
    """Return whether a switch cannot pay on three tasks any more, so that more runs are useless.

    A task on which it had nothing to do is one on which it did not pay.
    """
    lost = sum(not gain.pays for gain in gains(cells) if gain.switches == name)
    return lost > len(TASKS) - _PAYING_TASKS
