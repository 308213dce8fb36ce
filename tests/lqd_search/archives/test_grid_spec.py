import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from ribs.archives import GridArchive

from lqd_search import GridSpec, GridSpecError, learn_grid_spec

RAMP = np.linspace(2.0, 4.0, 11)
BIT = np.tile([0.0, 1.0], 6)[:11]
STILL = np.full(11, 3.0)


def learned(*columns, cells=10_000):
    return learn_grid_spec(np.stack(columns, axis=1), cells=cells)


def test_a_range_is_padded_by_a_twentieth_a_side():
    spec = learned(RAMP, -RAMP)
    assert spec.dims == (100, 100)
    assert spec.ranges[0] == pytest.approx((1.9, 4.1))
    assert spec.ranges[1] == pytest.approx((-4.1, -1.9))


def test_zeros_and_ones_get_two_cells_and_the_others_share_the_rest():
    spec = learned(RAMP, BIT, RAMP)
    assert spec.dims == (71, 2, 71)
    assert spec.ranges[1] == (-0.5, 1.5)


def test_a_constant_gets_one_cell():
    spec = learned(RAMP, STILL)
    assert spec.dims == (10_000, 1)
    assert spec.ranges[1] == (2.5, 3.5)


def test_only_zeros_or_only_ones_are_a_constant():
    assert learned(RAMP, np.zeros(11)).dims[1] == 1
    assert learned(RAMP, np.ones(11)).dims[1] == 1


def test_a_half_beside_zeros_and_ones_makes_a_range():
    spec = learned(RAMP, np.where(RAMP == 3.0, 0.5, BIT))
    assert spec.dims == (100, 100)
    assert spec.ranges[1] == pytest.approx((-0.05, 1.05))


def test_a_huge_constant_still_has_a_range():
    (lower, upper), _ = learned(np.full(11, 1e18), RAMP).ranges
    assert lower < 1e18 < upper


def test_nothing_that_varies_gives_few_cells():
    assert learned(STILL, STILL).cells == 1
    assert learned(BIT, BIT, STILL).dims == (2, 2, 1)


@pytest.mark.parametrize(("dimensions", "each"), [(1, 10_000), (2, 100), (3, 22), (4, 10), (5, 6)])
def test_cells_are_shared_evenly(dimensions, each):
    assert learned(*[RAMP] * dimensions).dims == (each,) * dimensions


def test_rows_with_a_measure_out_of_range_are_found():
    spec = GridSpec(dims=(10, 10), ranges=((0.0, 1.0), (0.0, 1.0)))
    rows = np.array([[0.0, 1.0], [1.1, 0.5], [-0.1, 7.0], [0.5, -0.01]])
    assert spec.out_of_range(rows).tolist() == [False, True, True, True]


def test_it_goes_through_json():
    spec = learned(RAMP, BIT)
    assert GridSpec.from_dict(json.loads(json.dumps(spec.to_dict()))) == spec


def test_it_is_made_of_arrays_too():
    data = {"dims": np.array([2, 3]), "ranges": np.array([[0.0, 1.0], [-1.0, 1.0]])}
    assert GridSpec.from_dict(data) == GridSpec(dims=(2, 3), ranges=((0.0, 1.0), (-1.0, 1.0)))


@pytest.mark.parametrize(
    ("dims", "ranges", "message"),
    [
        ((), (), "0 numbers of cells and 0 ranges"),
        ((2,), ((0, 1), (0, 1)), "1 numbers of cells and 2 ranges"),
        ((2, 0), ((0, 1), (0, 1)), r"at least 1 cell per dimension, but got \(2, 0\)"),
        ((2,), ((1, 1),), r"finite lower bound below .* \(1, 1\)"),
        ((2,), ((0, np.inf),), r"finite lower bound below .* \(0, inf\)"),
    ],
)
def test_a_spec_without_sense_is_refused(dims, ranges, message):
    with pytest.raises(GridSpecError, match=message):
        GridSpec(dims=dims, ranges=ranges)


def test_a_spec_without_keys_is_refused():
    with pytest.raises(GridSpecError, match=r"keys 'dims' and 'ranges', but got \['dims'\]"):
        GridSpec.from_dict({"dims": [1]})


@pytest.mark.parametrize("values", [np.zeros((0, 2)), np.zeros(3), np.array([[0.0, np.nan]])])
def test_nothing_is_learned_from_what_is_not_there(values):
    with pytest.raises(GridSpecError, match="leave undefined rows out"):
        learn_grid_spec(values)


FINITE = st.floats(allow_nan=False, allow_infinity=False)


@given(arrays(np.float64, st.tuples(st.integers(1, 12), st.integers(1, 5)), elements=FINITE))
def test_whatever_is_finite_gives_a_grid_that_pyribs_takes(values):
    spec = learn_grid_spec(values)
    assert 1 <= spec.cells <= 11_000
    GridArchive(solution_dim=1, dims=spec.dims, ranges=spec.ranges)
    assert not spec.out_of_range(np.clip(values, -1e100, 1e100)).any()
