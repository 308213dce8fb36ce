"""What became of all evaluations of a run, counted."""

from collections import Counter
from dataclasses import dataclass, field

import numpy as np

from lqd_envs import Verdict
from lqd_search.evaluation.motion_evaluator import EXPERT, VERDICT
from lqd_search.evaluation.values import Refusal, Values

RefusalKey = tuple[str, str, str]


@dataclass
class Tally:
    """Counts over a run, updated with every batch.

    Attributes:
        evaluations: All solutions so far, whatever became of them.
        verdicts: How many got each verdict.
        inferred_successes: How many motions the inferred condition approved.
        expert_successes: How many motions the expert's condition approved.
        confusion: (2, 2) counts of valid motions, [expert's word][inferred word].
        refusals: How often a functional's value was refused, by (kind, functional, reason).
    """

    evaluations: int = 0
    verdicts: Counter[Verdict] = field(default_factory=Counter)
    inferred_successes: int = 0
    expert_successes: int = 0
    confusion: list[list[int]] = field(default_factory=lambda: [[0, 0], [0, 0]])
    refusals: Counter[RefusalKey] = field(default_factory=Counter)

    def add(self, values: Values) -> list[Refusal]:
        """Count one batch.

        Returns:
            The refusals for a reason that this functional had not been refused for before.
        """
        verdicts, expert = values.passive[VERDICT], values.passive[EXPERT]
        for verdict, count in zip(*np.unique(verdicts, return_counts=True), strict=True):
            self.verdicts[Verdict(int(verdict))] += int(count)
        self.inferred_successes += int(values.success.sum())
        self.expert_successes += int(expert.sum())
        for truth in (False, True):
            for inferred in (False, True):
                cases = values.valid & (expert == truth) & (values.success == inferred)
                self.confusion[truth][inferred] += int(cases.sum())
        self.evaluations += len(values)
        return self._add_refusals(values.refusals)

    @property
    def valid(self) -> int:
        """Motions that were judged."""
        return self.verdicts[Verdict.VALID]

    @property
    def rejected(self) -> dict[str, int]:
        """Motions that failed before simulation, by cause."""
        return {v.name.lower(): self.verdicts[v] for v in Verdict if v.rejected}

    @property
    def discarded(self) -> dict[str, int]:
        """Motions that failed in simulation, by cause."""
        return {v.name.lower(): self.verdicts[v] for v in Verdict if v.discarded}

    @property
    def refused(self) -> int:
        """Values of functionals that were refused."""
        return sum(self.refusals.values())

    def _add_refusals(self, refusals: tuple[Refusal, ...]) -> list[Refusal]:
        fresh = []
        for refusal in refusals:
            key = (refusal.kind, refusal.functional, refusal.reason)
            if key not in self.refusals:
                fresh.append(refusal)
            self.refusals[key] += refusal.count
        return fresh
