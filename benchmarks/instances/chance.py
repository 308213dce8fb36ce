"""The probability that a random subset has a member of some kind."""

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import gammaln


def chance(n: ArrayLike, solving: ArrayLike, size: ArrayLike) -> NDArray[np.float64]:
    """Return the probability that at least one of a random subset solves.

    It is exact: one less the share of the subsets that have none, `C(n - s, k) / C(n, k)`. Where
    the subset would be larger than what there is, it is all there is.

    Args:
        n: How many there are, at least 0.
        solving: How many of them solve, at most n.
        size: Size of the subset, at least 0.

    Returns:
        Float64 in [0, 1], of the shape that the arguments have together.
    """
    n, s, k = np.broadcast_arrays(*(np.asarray(x, np.float64) for x in (n, solving, size)))
    k = np.minimum(k, n)
    # With fewer others than the subset has members, one of them solves.
    certain = n - s < k
    left = np.where(certain, 0.0, n - s - k)
    log_none = gammaln(n - s + 1.0) - gammaln(left + 1.0) - gammaln(n + 1.0) + gammaln(n - k + 1.0)
    # One that cannot be, by a rounding error above 0, is 0.
    return np.where(certain, 1.0, -np.expm1(np.minimum(log_none, 0.0)))
