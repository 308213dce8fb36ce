"""A mean over runs and instances, and how far it can be trusted."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from benchmarks.instances.percent import percent

CONFIDENCE = 0.95
RESAMPLES = 2000


@dataclass(frozen=True)
class Rate:
    """A mean over runs and instances.

    Attributes:
        value: The mean.
        low: Lower end of its bootstrap interval; NaN: there is none, since a single run in a single
            instance says nothing of others.
        high: Upper end.
    """

    value: float
    low: float
    high: float

    @property
    def text(self) -> str:
        """As it stands in a table, in percent."""
        if math.isnan(self.low):
            return percent(self.value)
        low, high = (percent(end).removesuffix("%") for end in (self.low, self.high))
        return f"{percent(self.value)} [{low}, {high}]"


def two_way(values: NDArray[np.float64], *, rng: np.random.Generator) -> list[Rate]:
    """Return the mean of each figure with a percentile bootstrap interval.

    Runs and instances are both drawn anew, each among themselves, and what a drawn run came to in a
    drawn instance is taken: the interval speaks for other runs and for other instances. With a
    single run it speaks for instances alone, and the other way round.

    Args:
        values: (runs, instances, figures), at least one of each.
        rng: Draws the resamples. All figures share them.
    """
    runs, instances, _ = values.shape
    means = values.mean(axis=(0, 1))
    if runs == instances == 1:
        return [Rate(float(mean), math.nan, math.nan) for mean in means]
    resampled = _resampled(values, of_runs=_times_drawn(runs, rng), rng=rng)
    return [_rate(mean, draws) for mean, draws in zip(means, resampled.T, strict=True)]


def mean_over_groups(
    tasks: Iterable[Sequence[NDArray[np.float64]]], *, rng: np.random.Generator
) -> Rate:
    """Return the mean over tasks and kinds of instances with a percentile bootstrap interval.

    Each task and kind counts as much as another. Each has instances of its own, drawn anew by
    themselves; the runs of a task are the same for all its kinds, and so are those that are drawn
    anew. Where a kind has a single run and a single instance, there is no interval.

    Args:
        tasks: For each task, for each kind (runs, instances), at least one of each.
        rng: Draws the resamples.
    """
    means: list[float] = []
    resampled: list[NDArray[np.float64]] = []
    for kinds in tasks:
        of_runs = _times_drawn(len(kinds[0]), rng)
        for values in kinds:
            means.append(float(values.mean()))
            alone = values.size == 1
            resampled.append(
                np.full(RESAMPLES, math.nan)
                if alone
                else _resampled(values[:, :, None], of_runs=of_runs, rng=rng)[:, 0]
            )
    return _rate(float(np.mean(means)), np.mean(resampled, axis=0))


def _times_drawn(n: int, rng: np.random.Generator) -> NDArray[np.int64]:
    return rng.multinomial(n, np.full(n, 1.0 / n), RESAMPLES)


def _resampled(
    values: NDArray[np.float64], *, of_runs: NDArray[np.int64], rng: np.random.Generator
) -> NDArray[np.float64]:
    """Return (resamples, figures) the means, with instances that are drawn here."""
    runs, instances, _ = values.shape
    of_instances = _times_drawn(instances, rng)
    # Divided at the end, so that the mean of ones is one.
    sums = np.einsum("br,rif,bi->bf", of_runs, values, of_instances, optimize=True)
    return np.asarray(sums / (runs * instances))


def _rate(mean: float, resampled: NDArray[np.float64]) -> Rate:
    tail = 50.0 * (1.0 - CONFIDENCE)
    low, high = np.percentile(resampled, [tail, 100.0 - tail])
    return Rate(float(mean), float(low), float(high))
