import numpy as np
import pytest

from lqd_envs import get_task
from lqd_envs.discarded import spoils, too_deep, too_fast
from lqd_envs.instances import Instance, Obstacle
from lqd_envs.scene import load_scene

PUSH = "LQD/Push-v0"
BOX = Obstacle((-0.3, 0.5, 0.05), (0.02, 0.02, 0.05))


@pytest.fixture(scope="module")
def sensors():
    """The sensors of a scene with a mug and an obstacle."""
    return load_scene(Instance(PUSH, obstacles=(BOX,)).apply(get_task(PUSH))).sensors


def sensordata(sensors, **values):
    """(2, 3, n) sensor values, all zero but for those named at one moment of the second motion."""
    n = max(part.stop for part in sensors.slices.values())
    data = np.zeros((2, 3, n))
    for name, value in values.items():
        part = sensors.slices[name.replace("speed_", "speed:")]
        data[1, 2, part.start : part.start + len(value)] = value
    return data


@pytest.mark.parametrize(
    ("values", "spoilt", "deep", "fast"),
    [
        ({}, False, False, False),
        ({"robot_contact": (1.0, -0.003)}, False, False, False),
        ({"robot_contact": (1.0, -0.00301)}, True, True, False),
        ({"robot_contact": (0.0, -0.1)}, False, False, False),
        ({"object_contact": (2.0, -0.00301)}, True, True, False),
        ({"speed_mug_handle": (0.0, 2.0, 0.0)}, False, False, False),
        ({"speed_mug_handle": (0.0, 2.0, 0.1)}, True, False, True),
        ({"robot_obstacle": (1.0, 0.0)}, True, False, False),
        ({"robot_obstacle": (1.0, 0.0), "object_contact": (1.0, -1.0)}, True, True, False),
    ],
)
def test_what_spoils_a_motion(sensors, values, spoilt, deep, fast):
    data = sensordata(sensors, **values)

    for function, expected in ((spoils, spoilt), (too_deep, deep), (too_fast, fast)):
        found = function(sensors, data)
        assert (found.shape, found.dtype) == ((2, 3), np.bool_)
        assert found[1, 2] == expected
        assert found.sum() == expected
        assert bool(function(sensors, data[1, 2])) == expected


def test_scene_without_obstacles_can_be_spoilt_too(scene):
    data = np.zeros(scene.model.nsensordata)
    assert not spoils(scene.sensors, data)
    part = scene.sensors.slices["robot_contact"]
    data[part.start : part.start + 2] = (1.0, -0.01)

    assert spoils(scene.sensors, data)
