import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from lqd_envs.instances import ApproachLimit, InstanceError
from lqd_envs.instances.approach_limit import pointing

DOWN = (0.0, 0.0, -1.0)


@pytest.mark.parametrize(
    ("orientation", "direction"),
    [
        ((0.0, 0.0, 0.0), DOWN),
        ((0.0, 0.0, 1.0), DOWN),
        ((0.0, -math.pi / 2, 0.0), (1.0, 0.0, 0.0)),
        ((math.pi / 2, 0.0, 0.0), (0.0, 1.0, 0.0)),
    ],
)
def test_where_the_fingers_point(orientation, direction):
    np.testing.assert_allclose(pointing(np.array([orientation])), [direction], atol=1e-12)


@settings(deadline=None, derandomize=True, max_examples=200)
@given(st.tuples(*[st.floats(-math.pi, math.pi)] * 3))
def test_pointing_is_the_rotation_of_the_fingers(orientation):
    rotated = Rotation.from_euler("xyz", [orientation]).apply(DOWN)

    np.testing.assert_allclose(pointing(np.array([orientation])), rotated, atol=1e-12)


@pytest.mark.parametrize(
    ("tilt", "holds"), [(0.0, True), (0.29, True), (-0.29, True), (0.31, False), (-1.5, False)]
)
def test_cone_around_straight_down(solving, tilt, holds):
    columns = solving("LQD/Grasp-v0").columns.rows(np.arange(1))
    orientation = np.zeros((1, 2, 3))
    orientation[0, 0, 0] = tilt
    orientation[0, 1, 0] = 1.5 if holds else 0.0  # the end does not count
    columns = replace(columns, gripper_orientation=orientation)

    assert ApproachLimit(DOWN, 0.3).holds(columns).tolist() == [holds]
    assert ApproachLimit((0.0, 0.0, -20.0), 0.3).holds(columns).tolist() == [holds]


def test_errors():
    with pytest.raises(InstanceError, match="a `direction` of some length"):
        ApproachLimit((0.0, 0.0, 0.0), 0.3)
    with pytest.raises(InstanceError, match="`direction` to be 3 numbers, but got 2"):
        ApproachLimit((0.0, 1.0), 0.3)
    with pytest.raises(InstanceError, match=r"`half_angle` to be a number from 0\.001 to 3"):
        ApproachLimit(DOWN, 4.0)
    with pytest.raises(InstanceError, match=r"but got 0\.0; choose one"):
        ApproachLimit(DOWN, 0.0)
    with pytest.raises(InstanceError, match=r"`direction` to be 3 numbers, but got np\.float64"):
        ApproachLimit(np.float64(1.0), 0.3)
