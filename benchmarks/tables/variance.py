"""Telling variances apart: two crossed random factors with one value for each pair."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

DRAWS = 20_000
CONFIDENCE = 0.95


@dataclass(frozen=True)
class Share:
    """A component of a variance.

    Attributes:
        variance: Its estimate, at least 0.
        share: Its share of the sum of all components; NaN: nothing varies.
        low: Lower end of the share's interval.
        high: Upper end.
    """

    variance: float
    share: float
    low: float
    high: float


@dataclass(frozen=True)
class Variances:
    """The components of the variance of crossed values.

    Attributes:
        rows: What differs from row to row, on average over the columns.
        columns: What differs from column to column, on average over the rows.
        rest: What is left: the interaction of the two.
    """

    rows: Share
    columns: Share
    rest: Share

    @property
    def but_rows(self) -> Share:
        """Columns and rest together."""
        rows, variance = self.rows, self.columns.variance + self.rest.variance
        return Share(variance, 1.0 - rows.share, low=1.0 - rows.high, high=1.0 - rows.low)


def split_variance(table: NDArray[np.float64], *, rng: np.random.Generator) -> Variances:
    """Estimate how much rows and columns, as random factors, contribute to the variance.

    The estimates are those of the analysis of variance, negative ones being set to 0. The intervals
    are generalized confidence intervals: each sum of squares is divided by draws of its chi-squared
    distribution, which supposes normal effects.

    Args:
        table: (rows, columns) values, at least two of each.
        rng: Draws for the intervals.
    """
    rows, columns = table.shape
    overall = table.mean()
    by_row = table.mean(axis=1, keepdims=True) - overall
    by_column = table.mean(axis=0, keepdims=True) - overall
    left = table - overall - by_row - by_column
    sums = np.array([columns * np.sum(by_row**2), rows * np.sum(by_column**2), np.sum(left**2)])
    freedom = np.array([rows - 1, columns - 1, (rows - 1) * (columns - 1)])
    estimates = _components(sums / freedom, rows=rows, columns=columns)
    if not estimates.sum() > 0.0:
        nothing = Share(0.0, np.nan, np.nan, np.nan)
        return Variances(nothing, nothing, nothing)
    draws = sums[:, None] / rng.chisquare(freedom[:, None], (3, DRAWS))
    drawn = _components(draws, rows=rows, columns=columns)
    tail = 50.0 * (1.0 - CONFIDENCE)
    low, high = np.percentile(drawn / drawn.sum(axis=0), [tail, 100.0 - tail], axis=1)
    shares = estimates / estimates.sum()
    return Variances(
        *(
            Share(float(estimates[i]), float(shares[i]), float(low[i]), float(high[i]))
            for i in range(3)
        )
    )


def _components(squares: NDArray[np.float64], *, rows: int, columns: int) -> NDArray[np.float64]:
    """Return the variances of rows, columns and rest that go with mean squares."""
    of_rows, of_columns, rest = squares
    components = np.array([(of_rows - rest) / columns, (of_columns - rest) / rows, rest])
    return components.clip(min=0.0)
