"""Moments after which nothing is a success any more, such as no real contact shows."""

import numpy as np
from numpy.typing import NDArray

from lqd_envs.scenes.sensors import SensorReader
from lqd_envs.verdict import DEEPEST_CONTACT, FASTEST_OBJECT


def too_deep(sensors: SensorReader, sensordata: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return (...) bool: whether a contact of robot or object is deeper than 3 mm.

    Args:
        sensors: The scene's sensors.
        sensordata: (..., nsensordata) their values.
    """
    return np.asarray(sensors.depth(sensordata) > DEEPEST_CONTACT)


def too_fast(sensors: SensorReader, sensordata: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return (...) bool: whether the object's farthest point is faster than 2 m/s.

    Args:
        sensors: The scene's sensors.
        sensordata: (..., nsensordata) their values.
    """
    return np.asarray(sensors.speed(sensordata) > FASTEST_OBJECT)


def spoils(sensors: SensorReader, sensordata: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return (...) bool: whether no motion through these moments can be a success.

    The robot touches an obstacle, a contact is too deep, or the object is too fast. That the
    simulation diverged stands with the simulation, not in its sensors.

    Args:
        sensors: The scene's sensors.
        sensordata: (..., nsensordata) their values.
    """
    touched = sensors.robot_touches_obstacle(sensordata)
    return touched | too_deep(sensors, sensordata) | too_fast(sensors, sensordata)
