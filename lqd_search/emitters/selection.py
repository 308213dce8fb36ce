"""The rule by which parents are selected from one grid: MAP-Elites Success."""

import numpy as np
from numpy.typing import NDArray

from lqd_envs.errors import LQDError


class SelectionError(LQDError):
    """Parents were wanted where there are none."""


def select_parents(
    n: int, *, success: NDArray[np.bool_], rng: np.random.Generator
) -> NDArray[np.intp]:
    """Select n parents from the elites of one grid, successes first.

    This is the selection of the paper's MAP-Elites Success, without tournaments. If there are at
    least n successes, n of them without replacement. Otherwise, if there are at least n elites, all
    successes and the rest uniformly without replacement from the others. Otherwise n uniformly with
    replacement from all elites.

    Args:
        n: Number of parents.
        success: (m,) bool, whether each elite is a success.
        rng: Draws them.

    Returns:
        (n,) indices of elites.

    Raises:
        SelectionError: There is no elite, or n is negative.
    """
    elites = len(success)
    if elites == 0 or n < 0:
        raise SelectionError(
            f"Expected to select 0 or more parents from at least one elite, but got {n} from "
            f"{elites}; leave empty grids out."
        )
    successes = np.flatnonzero(success)
    if len(successes) >= n:
        return rng.choice(successes, size=n, replace=False)
    if elites >= n:
        others = rng.choice(np.flatnonzero(~success), size=n - len(successes), replace=False)
        return np.concatenate([successes, others])
    return rng.integers(elites, size=n)
