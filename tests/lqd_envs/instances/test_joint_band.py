from dataclasses import replace

import numpy as np
import pytest

from lqd_envs import get_task
from lqd_envs.instances import InstanceError, JointBand


@pytest.mark.parametrize(
    ("band", "angles", "holds"),
    [
        (JointBand("hot_tap", 0.5, 1.0), (0.5, 0.0), True),
        (JointBand("hot_tap", 0.5, 1.0), (1.0, 2.0), True),
        (JointBand("hot_tap", 0.5, 1.0), (np.nextafter(0.5, 0.0), 0.7), False),
        (JointBand("hot_tap", 0.5, 1.0), (np.nextafter(1.0, 2.0), 0.7), False),
        (JointBand("cold_tap", 0.0, 0.05), (1.0, 0.05), True),
        (JointBand("cold_tap", 0.0, 0.05), (0.0, 0.06), False),
        # A stop that yields: neither below closed nor beyond fully open.
        (JointBand("cold_tap", 0.0, 0.05), (1.0, -0.001), True),
        (JointBand("hot_tap", 2.0, 2.0944), (2.10, 0.0), True),
    ],
)
def test_last_position_of_the_joint_counts(solving, band, angles, holds):
    columns = solving("LQD/Faucet-v0").columns
    joints = np.zeros((1, 3, 2))
    joints[0, 1] = 0.7
    joints[0, -1] = angles

    assert band.holds(replace(columns, joint_positions=joints)).tolist() == [holds]


def test_joint_must_be_the_task_s():
    JointBand("drawer", 0.1, 0.12).require_fits(get_task("LQD/Drawer-v0"))
    with pytest.raises(InstanceError, match="'drawer'; its joints are: hot_tap, cold_tap"):
        JointBand("drawer", 0.1, 0.12).require_fits(get_task("LQD/Faucet-v0"))
    with pytest.raises(InstanceError, match="its joints are: none"):
        JointBand("drawer", 0.1, 0.12).require_fits(get_task("LQD/Push-v0"))


@pytest.mark.parametrize(
    ("task_id", "band", "reach"),
    [
        (
            "LQD/Faucet-v0",
            JointBand("hot_tap", 3.0, 4.0),
            "from 0 to 2.094 rad, but got one from 3 to",
        ),
        ("LQD/Faucet-v0", JointBand("cold_tap", 2.1, 2.2), "from 0 to 2.094 rad"),
        ("LQD/Drawer-v0", JointBand("drawer", 0.21, 0.3), "from 0 to 0.2 m, but got one from 0.21"),
    ],
)
def test_band_must_begin_within_the_joint_s_range(task_id, band, reach):
    with pytest.raises(InstanceError, match=f"of {task_id} reaches, which goes {reach}"):
        band.require_fits(get_task(task_id))


def test_band_may_end_beyond_the_joint_s_range():
    JointBand("drawer", 0.2, 0.3).require_fits(get_task("LQD/Drawer-v0"))
    JointBand("hot_tap", 2.0, 2.0944).require_fits(get_task("LQD/Faucet-v0"))


@pytest.mark.parametrize(
    ("low", "high", "message"),
    [
        (0.2, 0.1, "`low` below `high`, but got 0.2 and 0.1"),
        (0.1, 0.1, "`low` below `high`"),
        (-0.1, 0.1, "`low` to be a number from 0 to 10, but got -0.1"),
        (0.1, float("nan"), "`high` to be a number from 0 to 10, but got nan"),
        (0.1, "much", "`high` to be a number from 0 to 10, but got 'much'"),
        (0.1, 10**400, "`high` to be a number from 0 to 10, but got 1000"),
        (True, 2.0, "`low` to be a number from 0 to 10, but got True"),
    ],
)
def test_ends_must_be_a_band(low, high, message):
    with pytest.raises(InstanceError, match=message):
        JointBand("hot_tap", low, high)
