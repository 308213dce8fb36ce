"""By what the better of two elites is told."""

import numpy as np
from numpy.typing import NDArray


def worth_of(objective: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return each elite's objective, by which the better of two is told.

    Args:
        objective: (m,) float64; NaN where undefined, as random search may put it out.

    Returns:
        (m,) float64: the same; the lowest of all where it is undefined.
    """
    return np.where(np.isnan(objective), -np.inf, objective)
