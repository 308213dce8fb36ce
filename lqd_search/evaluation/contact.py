"""Where a motion first touched the object, as the start of another motion could stand there."""

import numpy as np
from numpy.typing import NDArray

from lqd_envs import Trajectories
from lqd_envs.solution_space import POSITION_UNIT
from lqd_search.evaluation.values import Values, ValuesError

CONTACT = "contact"
"""Perceived column: (N, 6) float64, the gripper's pose when it first touched the object, in the
units of a solution's start; NaN where it touched nothing."""


def first_contacts(trajectories: Trajectories) -> NDArray[np.float64]:
    """Return the gripper's pose at each motion's first contact with the object.

    Args:
        trajectories: N motions.

    Returns:
        (N, 6) float64: position relative to the task's centre in units of 0.10 m, then roll, pitch
        and yaw; NaN where the motion failed or touched nothing.
    """
    columns = trajectories.columns
    touching = np.any(columns.gripper_contacts, axis=2)
    first = (np.arange(len(trajectories)), touching.argmax(axis=1))
    position = (columns.gripper_position[first] - trajectories.task.center) / POSITION_UNIT
    pose = np.concatenate([position, columns.gripper_orientation[first]], axis=1)
    touched = touching.any(axis=1) & trajectories.valid
    return np.where(touched[:, None], pose, np.nan)


def touched(values: Values) -> NDArray[np.bool_]:
    """Return which motions touched the object.

    Args:
        values: With the perceived column `contact`.

    Returns:
        (N,) bool.

    Raises:
        ValuesError: They have no such column.
    """
    if CONTACT not in values.perceived:
        raise ValuesError(
            f"Expected the perceived column {CONTACT!r} among the values, but there are only "
            f"{', '.join(values.perceived) or 'none'}; evaluate with a MotionEvaluator."
        )
    return np.asarray(~np.isnan(values.perceived[CONTACT][:, 0]))
