"""By what the better of two elites is told."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray


def worth_of(fields: Mapping[str, NDArray[Any]]) -> NDArray[np.float64]:
    """Return (m,) float64: each elite's fitness; the lowest of all where it has none."""
    objective = fields["objective"]
    return np.where(np.isnan(objective), -np.inf, objective)
