"""How a measure spreads over the seeds."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

NOTHING = "-"
"""What stands in a table where there is no number."""


@dataclass(frozen=True)
class Spread:
    """How a measure spreads over the seeds.

    Attributes:
        n: Values that are defined.
        mean: Their mean.
        std: Their sample standard deviation (n - 1); NaN: there is only one.
        median: Their median.
        low: Their first quartile.
        high: Their third quartile.
    """

    n: int
    mean: float
    std: float
    median: float
    low: float
    high: float

    @classmethod
    def of(cls, values: Iterable[float]) -> "Spread | None":
        """Return the spread of the values that are not NaN; None: there are none."""
        numbers = np.array([value for value in values if not np.isnan(value)], float)
        if not len(numbers):
            return None
        low, median, high = np.percentile(numbers, [25, 50, 75])
        return cls(
            n=len(numbers),
            mean=float(numbers.mean()),
            std=float(numbers.std(ddof=1)) if len(numbers) > 1 else float("nan"),
            median=float(median),
            low=float(low),
            high=float(high),
        )

    def mean_text(self, digits: int = 1) -> str:
        """Return mean ± standard deviation."""
        if np.isnan(self.std):
            return f"{self.mean:,.{digits}f}"
        return f"{self.mean:,.{digits}f} ± {self.std:,.{digits}f}"

    def median_text(self, digits: int = 1) -> str:
        """Return median [interquartile range]."""
        return f"{self.median:,.{digits}f} [{self.low:,.{digits}f}, {self.high:,.{digits}f}]"
