import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lqd_envs import get_task
from lqd_envs.instances import InstanceError, MovedSector
from lqd_envs.perception import Columns
from lqd_envs.tasks.grasp import MUG_SCHEMA


def moved(*ways):
    """Columns in which the mug goes these ways from (0.5, 0.1)."""
    n = len(ways)
    position = np.zeros((n, 2, 3))
    position[:, :, :2] = (0.5, 0.1)
    position[:, 1, :2] += ways
    return Columns(
        schema=MUG_SCHEMA,
        object_position=position,
        object_orientation=np.zeros((n, 2, 3)),
        object_table_contact=np.ones((n, 2), dtype=bool),
        robot_table_contact=np.zeros((n, 2), dtype=bool),
        gripper_position=np.zeros((n, 2, 3)),
        gripper_orientation=np.zeros((n, 2, 3)),
        gripper_contacts=np.zeros((n, 2, 1), dtype=bool),
        joint_positions=np.zeros((n, 2, 0)),
    )


def test_direction_and_distance():
    left = MovedSector(direction=math.pi / 2, half_width=0.5, nearest=0.06, farthest=0.1)

    ways = [(0.0, 0.08), (0.0, 0.05), (0.0, 0.11), (0.0, -0.08), (0.03, 0.07), (0.06, 0.06)]
    assert left.holds(moved(*ways)).tolist() == [True, False, False, False, True, False]


def test_a_sector_may_lie_across_the_back():
    back = MovedSector(direction=math.pi, half_width=0.3, nearest=0.05, farthest=0.2)

    assert back.holds(moved((-0.1, 0.01), (-0.1, -0.01), (0.1, 0.01))).tolist() == [
        True,
        True,
        False,
    ]


@settings(deadline=None, derandomize=True, max_examples=200)
@given(
    direction=st.floats(-math.pi, math.pi),
    half_width=st.floats(0.01, math.pi),
    angle=st.floats(-math.pi, math.pi),
)
def test_sector_is_that_of_the_angles(direction, half_width, angle):
    sector = MovedSector(direction, half_width, nearest=0.05, farthest=0.2)
    between = abs(math.remainder(angle - direction, 2 * math.pi))
    holds = sector.holds(moved((0.1 * math.cos(angle), 0.1 * math.sin(angle))))

    if abs(between - half_width) > 1e-6:
        assert holds.tolist() == [between < half_width]


def test_turns_with_what_happened(solving):
    motions = solving("LQD/Push-v0")
    way = motions.columns.object_position[:, -1] - motions.columns.object_position[:, 0]
    for row, (x, y, _) in enumerate(way):
        sector = MovedSector(math.atan2(y, x), 0.2, nearest=0.04, farthest=0.5)
        assert sector.holds(motions.columns)[row]
        opposite = replace(sector, direction=math.atan2(-y, -x))
        assert not opposite.holds(motions.columns)[row]


def test_object_must_be_free():
    sector = MovedSector(0.0, 0.5, nearest=0.05, farthest=0.1)

    sector.require_fits(get_task("LQD/Push-v0"))
    with pytest.raises(InstanceError, match="LQD/Drawer-v0, whose object is fixed"):
        sector.require_fits(get_task("LQD/Drawer-v0"))


def test_distances_must_be_a_band():
    with pytest.raises(InstanceError, match="`nearest` below `farthest`, but got"):
        MovedSector(0.0, 0.5, nearest=0.1, farthest=0.05)
