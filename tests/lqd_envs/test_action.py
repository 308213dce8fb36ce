import re

import numpy as np
import pytest

from lqd_envs import ManipulationEnv
from lqd_envs.scenes.panda import ARM_JOINTS, FINGER_JOINTS


@pytest.fixture(scope="module")
def action_map(scene):
    return scene.action_map


@pytest.fixture(scope="module")
def targets(action_map):
    """(500, 8): joint and finger targets all over their ranges."""
    return np.random.default_rng(2).uniform(action_map.low, action_map.high, (500, 8))


def test_targets_come_back_within_float32(action_map, targets):
    actions = action_map.actions(targets[:, :7], finger_target=targets[:, 7])
    controls = action_map.controls(actions)

    assert actions.shape == (500, 8)
    assert actions.dtype == np.float32
    assert controls.dtype == np.float64
    # Rounding to nearest: half a unit in the last place of a number of at most 1.
    resolution = (action_map.high - action_map.low) / 2 * np.finfo(np.float32).eps / 2
    assert np.all(np.abs(controls[:, :8] - targets) <= resolution + 1e-15)


def test_actions_come_back(action_map):
    actions = np.random.default_rng(3).uniform(-1.0, 1.0, (500, 8)).astype(np.float32)

    controls = action_map.controls(actions)
    again = action_map.actions(controls[:, :7], finger_target=controls[:, 7])

    # Near 0 a float32 is finer than the controls' own rounding.
    assert again == pytest.approx(actions, abs=1e-15, rel=1e-6)


def test_ends_of_the_ranges(scene, action_map):
    ends = scene.model.actuator_ctrlrange.T

    assert action_map.controls(-np.ones(8)) == pytest.approx(ends[0], abs=1e-15)
    assert action_map.controls(np.ones(8)) == pytest.approx(ends[1], abs=1e-15)
    assert action_map.controls(np.zeros(8)) == pytest.approx(ends.mean(axis=0), abs=1e-15)


def test_actions_outside_are_clipped(action_map):
    wild = np.array([-5.0, 1e9, -1.5, 0.25, -np.inf, np.inf, 2.0, -1.0001])

    clipped = action_map.controls([-1.0, 1.0, -1.0, 0.25, -1.0, 1.0, 1.0, -1.0])

    assert np.array_equal(action_map.controls(wild), clipped)


def test_targets_outside_are_clipped(action_map):
    actions = action_map.actions(np.full((1, 7), 9.0), finger_target=np.full(1, -9.0))

    assert actions.tolist() == [[1.0] * 7 + [-1.0]]


def test_fingers_are_doubled(action_map):
    controls = action_map.controls(np.linspace(-1.2, 1.2, 400).reshape(5, 10, 8))

    assert controls.shape == (5, 10, 9)
    assert np.array_equal(controls[..., 7], controls[..., 8])


def test_controls_are_in_the_order_of_the_actuators(scene):
    model = scene.model
    driven = [model.joint(model.actuator_trnid[i, 0]).name for i in range(model.nu)]

    assert driven == [*ARM_JOINTS, *FINGER_JOINTS]


def test_documented_table_is_the_map(action_map):
    rows = re.findall(r"\| (\d) \| .+? \| (-?[\d.]+) \| (-?[\d.]+) \|", ManipulationEnv.__doc__)

    low, high = zip(*((float(low), float(high)) for _, low, high in rows), strict=True)

    assert [int(entry) for entry, _, _ in rows] == list(range(8))
    assert low == pytest.approx(action_map.low, abs=1e-9)
    assert high == pytest.approx(action_map.high, abs=1e-9)
