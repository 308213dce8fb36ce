"""A mean over runs and instances, and how far it can be trusted."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

CONFIDENCE = 0.95
RESAMPLES = 2000


@dataclass(frozen=True)
class Rate:
    """A mean over runs and instances.

    Attributes:
        value: The mean.
        low: Lower end of its bootstrap interval; NaN: there is a single run and a single instance.
        high: Upper end.
    """

    value: float
    low: float
    high: float

    @property
    def text(self) -> str:
        """As it stands in a table, in percent."""
        if math.isnan(self.low):
            return f"{self.value:.0%}"
        return f"{self.value:.0%} [{100 * self.low:.0f}, {100 * self.high:.0f}]"


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
    of_runs = rng.multinomial(runs, np.full(runs, 1.0 / runs), RESAMPLES)
    of_instances = rng.multinomial(instances, np.full(instances, 1.0 / instances), RESAMPLES)
    # Divided at the end, so that the mean of ones is one.
    sums = np.einsum("br,rif,bi->bf", of_runs, values, of_instances, optimize=True)
    tail = 50.0 * (1.0 - CONFIDENCE)
    low, high = np.percentile(sums / (runs * instances), [tail, 100.0 - tail], axis=0)
    return [Rate(float(m), float(a), float(b)) for m, a, b in zip(means, low, high, strict=True)]
