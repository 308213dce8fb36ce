from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from benchmarks.held_parts import part_touched, touched
from lqd_envs import get_task, rollout
from lqd_envs.instances import HeldPart, InstanceError
from lqd_envs.scene import load_scene

PARTS = ("handle", "rim", "body")
# Found in archives of runs: pinches of the handle close to the wall, and grasps around two edges
# of the mug.
AT_THE_WALL = (
    (-0.152, 0.413, 0.074, -0.694, -1.473, -0.786, 0.078, 0.12, 0.661),
    (-0.082, 0.475, -0.162, -0.172, -1.299, -1.355, -0.537, 0.434, 0.443),
    (-0.228, 0.413, 0.046, -0.286, -1.378, -0.886, -0.665, -0.402, 0.438),
)
AROUND_EDGES = (
    (0.075, 0.325, 0.279, 0.4, 1.217, 1.538, -0.501, 0.123, 0.235),
    (-0.103, 0.276, 0.321, 0.16, 0.496, -1.27, 0.133, -0.139, 0.514),
    (-0.157, 0.352, -0.071, 0.017, -0.667, -1.248, 0.083, 0.736, 0.343),
    (-0.104, 0.473, -0.036, 0.034, 0.323, -1.396, -0.749, 0.41, 0.157),
)


def held(columns):
    """The names of the parts that hold, one row each."""
    every = np.array([HeldPart(part).holds(columns) for part in PARTS])
    return [[PARTS[i] for i in np.flatnonzero(row)] for row in every.T]


def test_each_of_the_motions_holds_one_part(solving):
    parts = held(solving("LQD/Grasp-v0").columns)

    assert parts == [["handle"]] * 3 + [["rim"]] * 3 + [["body"]] * 2


def test_a_pinch_of_the_handle_is_none_of_the_body_however_close_to_the_wall():
    motions = rollout("LQD/Grasp-v0", np.array(AT_THE_WALL + AROUND_EDGES))

    assert motions.success().all()
    assert held(motions.columns) == [["handle"]] * 3 + [["body"]] * 4


def test_fingers_beside_the_mug_hold_nothing(solving):
    columns = solving("LQD/Grasp-v0").columns.rows([6, 7])
    away = columns.gripper_position.copy()
    # Along their own plane, so that the mug's axis stays midway between the fingers.
    sideways = np.array(
        [
            Rotation.from_euler("xyz", gripper[-1]).apply((1.0, 0.0, 0.0))
            for gripper in columns.gripper_orientation
        ]
    )
    away[:, -1] += 0.2 * sideways * (1.0, 1.0, 0.0)

    assert held(columns) == [["body"]] * 2
    assert held(replace(columns, gripper_position=away)) == [[]] * 2


@pytest.mark.parametrize("given", [None, AT_THE_WALL + AROUND_EDGES])
def test_it_is_the_part_that_the_pads_touch(solving, given):
    motions = rollout("LQD/Grasp-v0", np.array(given)) if given else solving("LQD/Grasp-v0")
    scene = load_scene(get_task("LQD/Grasp-v0"))
    for row, (part,) in enumerate(held(motions.columns)):
        left, right = touched(scene, motions, row)
        assert part_touched(left, right) == part


def test_band_of_heights(solving):
    columns = solving("LQD/Grasp-v0").columns
    anywhere = HeldPart("rim").holds(columns)
    low, high = (
        HeldPart("rim", -0.05, 0.06).holds(columns),
        HeldPart("rim", 0.06, 0.15).holds(columns),
    )

    assert anywhere.tolist() == (low | high).tolist()
    assert not (low & high).any()


def test_turned_with_the_mug(solving):
    """The same grasp in a world that is turned about the vertical is the same grasp."""
    columns = solving("LQD/Grasp-v0").columns
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    quarter = np.array([0.0, 0.0, np.pi / 2])
    turned = replace(
        columns,
        object_position=columns.object_position @ turn.T,
        gripper_position=columns.gripper_position @ turn.T,
        object_orientation=columns.object_orientation + quarter,
        gripper_orientation=columns.gripper_orientation + quarter,
    )

    assert held(turned) == held(columns)


def test_no_motions(solving):
    columns = solving("LQD/Grasp-v0").columns.rows(np.arange(0))

    assert HeldPart("rim").holds(columns).shape == (0,)


def test_errors():
    with pytest.raises(InstanceError, match="'lid'; choose one of handle, rim, body"):
        HeldPart("lid")
    with pytest.raises(InstanceError, match=r"\['rim'\]; choose one of handle, rim, body"):
        HeldPart(["rim"])
    with pytest.raises(InstanceError, match="`low` below `high`"):
        HeldPart("rim", 0.05, 0.04)
    with pytest.raises(InstanceError, match="a task with the mug, but got LQD/Faucet-v0"):
        HeldPart("rim").require_fits(get_task("LQD/Faucet-v0"))
