"""Numbers as a report writes them."""

from typing import Any

import numpy as np
from numpy.typing import NDArray


def rounded(values: NDArray[np.float64], *, digits: int = 6) -> list[float | None]:
    """Return each number with so many significant digits; None where it is not finite."""
    return [float(f"{v:.{digits}g}") if np.isfinite(v) else None for v in values.tolist()]


def whole(values: NDArray[np.float64], *, step: float) -> list[int]:
    """Return an array's numbers, one after the other, as whole multiples of a step."""
    flat: list[Any] = np.rint(values / step).astype(np.int64).ravel().tolist()
    return flat
