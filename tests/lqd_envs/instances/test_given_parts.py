from dataclasses import dataclass

import numpy as np
import pytest

from lqd_envs.instances import (
    ApproachLimit,
    Instance,
    InstanceError,
    JointBand,
    Obstacle,
    SceneChange,
)

FAUCET = "LQD/Faucet-v0"
BOX = Obstacle((0.4, 0.2, 0.1), (0.02, 0.03, 0.1))
BAND = JointBand("hot_tap", 0.5, 1.0)


@dataclass(frozen=True)
class TouchesTheTable:
    """A predicate of one's own."""

    kind: str = "touches_the_table"

    def require_fits(self, task):
        pass

    def holds(self, columns):
        return np.asarray(columns.robot_table_contact[:, -1])


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        ({"predicate": {"kind": "x"}}, r"`predicate` to be of type Predicate or None, but got {'k"),
        ({"predicate": 3}, r"but got 3; take one from lqd_envs\.instances"),
        ({"predicate": JointBand}, r"`predicate` to be of type Predicate or None, but got <class"),
        ({"predicate": BOX}, r"`predicate` to be of type Predicate or None, but got Obstacle"),
        ({"approach": {"half_angle": 1}}, r"`approach` to be of type ApproachLimit or None, but"),
        ({"approach": BAND}, r"`approach` to be of type ApproachLimit or None, but got JointBand"),
        (
            {"change": {"mass": 2.0}},
            r"SceneChange or None, .*dictionaries with Instance\.from_dict",
        ),
        ({"change": ()}, r"`change` to be of type SceneChange or None, but got \(\)"),
        ({"obstacles": BOX}, r"a tuple of Obstacle, but got Obstacle.*; put it into brackets"),
        ({"obstacles": {"yaw": 1}}, r"a tuple of Obstacle, but got {'yaw.*Instance\.from_dict"),
        ({"obstacles": None}, r"a tuple of Obstacle, but got None"),
        ({"obstacles": "box"}, r"a tuple of Obstacle, but got 'box'"),
        ({"obstacles": [BOX, {"yaw": 1}]}, r"obstacles\[1\] to be of type .*Instance\.from_dict"),
        ({"obstacles": [3]}, r"obstacles\[0\] to be of type Obstacle, but got 3; take one"),
    ],
)
def test_parts_of_another_type_are_refused_at_once(parts, message):
    with pytest.raises(InstanceError, match=message):
        Instance(FAUCET, **parts)


def test_parts_of_the_right_type_are_taken():
    approach, change = ApproachLimit((0.0, 0.0, -1.0), 0.7), SceneChange()
    instance = Instance(FAUCET, BAND, iter([BOX, BOX]), approach, change)

    assert (instance.predicate, instance.approach, instance.change) == (BAND, approach, change)
    assert instance.obstacles == (BOX, BOX)
    own = TouchesTheTable()
    instance = Instance(FAUCET, predicate=own)
    assert instance.predicate is own
    assert instance.name.startswith("faucet-predicate-")
    with pytest.raises(InstanceError, match="one of joint_band, moved_sector, held_part, but got"):
        Instance.from_json(instance.to_json())


def test_a_predicate_of_one_s_own_that_cannot_be_written_is_refused():
    class Undecorated:
        kind = "undecorated"
        require_fits = TouchesTheTable.require_fits
        holds = TouchesTheTable.holds

    @dataclass(frozen=True)
    class Larger(TouchesTheTable):
        than: object = None

    for predicate in (Undecorated(), Larger(than=np.float32(3.0)), Larger(than=float("nan"))):
        with pytest.raises(InstanceError, match=r"a dataclass of plain values, but got .*frozen=T"):
            Instance(FAUCET, predicate=predicate)
