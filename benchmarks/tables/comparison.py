"""Comparing methods: Mann-Whitney U, Holm's correction and the effect size A12."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import PermutationMethod, bootstrap, mannwhitneyu

from benchmarks.tables.holm import holm

BOOTSTRAP_SEED = 20_260_101
RESAMPLES = 10_000
CONFIDENCE = 0.95
# 10 against 10 values can be dealt out in 184,756 ways.
_MOST_DEALS = 200_000
_BATCH = 20_000


@dataclass(frozen=True)
class Hypothesis:
    """A comparison that is declared: that two methods do not differ in a measure.

    Attributes:
        task: Short name of the task.
        measure: Name of the measure.
        one: Name of the one method, whose advantage is positive.
        other: Name of the other.
    """

    task: str
    measure: str
    one: str
    other: str


@dataclass(frozen=True)
class UTest:
    """The result of a two-sided Mann-Whitney U test.

    Attributes:
        p: Its p value.
        exact: Whether it is that of all deals of these values to the two groups, and not that of
            the normal approximation.
    """

    p: float
    exact: bool


@dataclass(frozen=True)
class EffectSize:
    """How often one is larger than the other.

    Attributes:
        a12: The probability that a run of the one has the larger value, a tie counting half.
        low: Lower end of its bootstrap interval; NaN: a group has a single value.
        high: Upper end.
    """

    a12: float
    low: float
    high: float


@dataclass(frozen=True)
class Comparison:
    """What became of a hypothesis.

    Attributes:
        hypothesis: What was compared.
        test: The test.
        adjusted: Its p value after Holm's correction over the whole family.
        effect: The effect size.
    """

    hypothesis: Hypothesis
    test: UTest
    adjusted: float
    effect: EffectSize


ValuesOf = Callable[[str, str, str], Sequence[float] | None]
"""Returns the values of a task, a method and a measure; None: not all of them are there."""


def compare(family: Sequence[Hypothesis], values_of: ValuesOf) -> list[Comparison]:
    """Carry out those comparisons of a family whose values are complete.

    The correction is for the whole family: a comparison that is missing counts as p = 1, so that
    no result looks better for having been looked at early.

    Args:
        family: All comparisons that were declared.
        values_of: Returns the values.
    """
    tests: dict[int, tuple[UTest, EffectSize]] = {}
    for i, hypothesis in enumerate(family):
        one = values_of(hypothesis.task, hypothesis.one, hypothesis.measure)
        other = values_of(hypothesis.task, hypothesis.other, hypothesis.measure)
        if one is not None and other is not None:
            # A generator for each, so that none depends on which others there are.
            rng = np.random.default_rng([BOOTSTRAP_SEED, i])
            tests[i] = (u_test(one, other), effect_size(one, other, rng=rng))
    adjusted = holm([tests[i][0].p if i in tests else 1.0 for i in range(len(family))])
    return [Comparison(family[i], test, adjusted[i], effect) for i, (test, effect) in tests.items()]


def u_test(one: Sequence[float], other: Sequence[float]) -> UTest:
    """Test whether two samples come from the same distribution, two-sided.

    Args:
        one: Values, at least one.
        other: The same.
    """
    together = [*one, *other]
    if len(set(together)) == 1:
        return UTest(1.0, exact=True)
    exact = math.comb(len(together), len(one)) <= _MOST_DEALS
    if not exact:
        method = "asymptotic"
    elif len(set(together)) == len(together):
        method = "exact"
    else:
        # With ties the tabulated distribution is wrong; that of all deals of these values is not.
        method = PermutationMethod(n_resamples=_MOST_DEALS, batch=_BATCH)
    return UTest(float(mannwhitneyu(one, other, method=method).pvalue), exact=exact)


def smallest_p(n: int) -> float:
    """Return the smallest p value that n against n values can have.

    Args:
        n: At least 1.
    """
    return min(1.0, 2 / math.comb(2 * n, n))


def effect_size(
    one: Sequence[float], other: Sequence[float], *, rng: np.random.Generator
) -> EffectSize:
    """Return Vargha and Delaney's A12 with a percentile bootstrap interval.

    Args:
        one: Values, at least one.
        other: The same.
        rng: Draws the resamples.
    """
    groups = (np.asarray(one, float), np.asarray(other, float))
    a12 = float(_a12(*groups))
    if min(map(len, groups)) < 2:
        return EffectSize(a12, math.nan, math.nan)
    interval = bootstrap(
        groups,
        _a12,
        n_resamples=RESAMPLES,
        confidence_level=CONFIDENCE,
        method="percentile",
        vectorized=True,
        rng=rng,
    ).confidence_interval
    return EffectSize(a12, float(interval.low), float(interval.high))


def _a12(
    one: NDArray[np.float64], other: NDArray[np.float64], axis: int = -1
) -> NDArray[np.float64]:
    one, other = np.moveaxis(one, axis, -1), np.moveaxis(other, axis, -1)
    wins = np.sign(one[..., :, None] - other[..., None, :]).mean(axis=(-1, -2))
    return np.asarray((wins + 1.0) / 2.0)
