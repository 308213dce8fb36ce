"""The shape that the tasks' dense rewards share."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

_APPROACH = 0.25
_SCALE = 0.1


def approach_and_progress(
    gripper: NDArray[np.float64], *, target: NDArray[np.float64], progress: ArrayLike
) -> NDArray[np.float64]:
    """Return a quarter for being at the target, and three quarters for progress with the task.

    Args:
        gripper: (N, 3) positions of the gripper, m.
        target: (N, 3) positions that it should come to, m.
        progress: (N,) share of the task that is done; values outside [0, 1] are clipped.

    Returns:
        (N,) float64 in [0, 1]: exp(-distance / 0.1 m) / 4 + 3 progress / 4.
    """
    distance = np.linalg.norm(gripper - target, axis=1)
    return np.asarray(
        _APPROACH * np.exp(-distance / _SCALE) + (1.0 - _APPROACH) * np.clip(progress, 0.0, 1.0)
    )
