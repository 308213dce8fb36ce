import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lqd_envs import GroundTruth

GRID = GroundTruth(
    descriptor=lambda columns: columns.gripper_position[:, -1, :2],
    names=("x (m)", "y (m)"),
    dims=(4, 5),
    ranges=((0.0, 1.0), (-2.0, 3.0)),
)


def cell_by_hand(row):
    """The definition, one number at a time."""
    index = []
    for value, dim, (low, high) in zip(row, GRID.dims, GRID.ranges, strict=True):
        if not low <= value <= high:
            return -1
        index.append(min(math.floor((value - low) / (high - low) * dim), dim - 1))
    return index[0] * GRID.dims[1] + index[1]


@settings(deadline=None, derandomize=True, max_examples=300)
@given(
    rows=st.lists(
        st.tuples(
            st.one_of(st.floats(-0.2, 1.2), st.sampled_from([k / 4 for k in range(5)])),
            st.one_of(st.floats(-2.5, 3.5), st.sampled_from([float(k) for k in range(-2, 4)])),
        )
        | st.tuples(st.floats(), st.floats()),
        max_size=8,
    )
)
def test_cells_are_those_of_the_definition(rows):
    cells = GRID.cells(np.array(rows, dtype=np.float64).reshape(-1, 2))

    assert cells.dtype == np.int64
    assert cells.tolist() == [cell_by_hand(row) for row in rows]


@pytest.mark.parametrize(
    ("row", "cell"),
    [
        ((0.0, -2.0), 0),
        ((0.0, -1.0), 1),
        ((0.25, -2.0), 5),
        ((1.0, 3.0), 19),
        ((np.nextafter(1.0, 0.0), np.nextafter(3.0, 0.0)), 19),
        ((np.nextafter(0.0, -1.0), 0.0), -1),
        ((np.nextafter(1.0, 2.0), 0.0), -1),
        ((0.5, 3.1), -1),
        ((np.nan, 0.0), -1),
        ((0.0, np.nan), -1),
        ((np.inf, 0.0), -1),
        ((0.0, -np.inf), -1),
    ],
)
def test_edges_of_the_grid(row, cell):
    assert GRID.cells(np.array([row])).tolist() == [cell]


def test_faucet_grid_has_a_hundred_cells_over_the_range_of_the_tap(faucet):
    grid = faucet.ground_truth
    angles = np.append((np.arange(100) + 0.5) * (2 * math.pi / 3) / 100, [2 * math.pi / 3, 2.1])

    assert grid.cells(angles[:, None]).tolist() == [*range(100), 99, -1]
    assert len(grid.names) == len(grid.dims) == len(grid.ranges) == 1


def test_successes_can_fill_85_cells(faucet):
    angles = np.linspace(0.314, 2 * math.pi / 3, 10_000)

    cells = faucet.ground_truth.cells(angles[:, None])

    # From cell 14, which 0.314 rad is the very end of.
    assert set(cells.tolist()) == set(range(14, 100))
    assert (cells == 14).sum() < 10


@pytest.mark.parametrize(
    ("angles", "success"),
    [
        ((0.0, 0.314), True),
        ((0.0, np.nextafter(0.314, 0.0)), False),
        ((0.0, 2.0), True),
        ((1.0, 0.0), False),
    ],
)
def test_expert_judges_the_last_moment_of_the_hot_tap(faucet, turning, angles, success):
    joints = np.zeros((1, 2, 2))
    joints[0, :, 0] = angles
    columns = replace(turning.columns, joint_positions=joints)

    assert faucet.success(columns).tolist() == [success]
    assert faucet.ground_truth.descriptor(columns).tolist() == [[angles[1]]]


def test_tap_pressed_past_its_stop_is_fully_open(faucet, turning):
    columns = replace(turning.columns, joint_positions=np.array([[[0.0, 0.0], [2.1, 0.0]]]))

    measures = faucet.ground_truth.descriptor(columns)

    assert measures.tolist() == [[2 * math.pi / 3]]
    assert faucet.ground_truth.cells(measures).tolist() == [99]
    assert faucet.success(columns).tolist() == [True]


def test_cold_tap_does_not_count(faucet, turning):
    columns = replace(turning.columns, joint_positions=np.array([[[0.0, 2.0], [0.0, 2.0]]]))

    assert faucet.success(columns).tolist() == [False]
    assert faucet.ground_truth.descriptor(columns).tolist() == [[0.0]]


def test_short_name(faucet):
    assert faucet.name == "faucet"
    assert replace(faucet, id="LQD/Push-v0").name == "push"


def test_instruction(faucet):
    assert faucet.instruction == "Turn on the hot water"
