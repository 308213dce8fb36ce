import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from lqd_search.solution_space import BoxSpace, SpaceError

BOX = BoxSpace([-1.0, 0.0], [1.0, 20.0])
LOWER, UPPER = np.array([-1.0, 0.0]), np.array([1.0, 20.0])
seeds = st.integers(0, 99)


def rng(seed=0):
    return np.random.default_rng(seed)


def inside(solutions):
    return ((solutions >= LOWER) & (solutions <= UPPER)).all()


@given(st.integers(0, 50), seeds)
def test_samples_and_mutants_lie_in_the_box(n, seed):
    sampled = BOX.sample(n, rng=rng(seed))
    mutants = BOX.mutate(sampled, rng=rng(seed))
    assert sampled.shape == mutants.shape == (n, BOX.dim)
    assert inside(sampled)
    assert inside(mutants)
    assert np.array_equal(sampled, BOX.sample(n, rng=rng(seed)))
    assert np.array_equal(mutants, BOX.mutate(sampled, rng=rng(seed)))


def test_samples_are_uniform():
    sampled = (BOX.sample(4000, rng=rng()) - LOWER) / (UPPER - LOWER)
    assert sampled.mean(axis=0) == pytest.approx([0.5, 0.5], abs=0.02)
    assert sampled.std(axis=0) == pytest.approx([12**-0.5] * 2, abs=0.01)


def test_mutation_has_a_spread_in_shares_of_the_width():
    middle = np.tile((LOWER + UPPER) / 2, (4000, 1))
    mutants = BoxSpace(LOWER, UPPER, std=0.05).mutate(middle, rng=rng())
    assert (mutants - middle).std(axis=0) == pytest.approx([0.1, 1.0], rel=0.05)


@given(arrays(np.float64, (5, 2), elements=st.floats(-1e300, 1e300)))
def test_repair_clips_and_leaves_what_is_inside_alone(solutions):
    repaired = BOX.repair(solutions)
    assert inside(repaired)
    assert BOX.repair(repaired).tobytes() == repaired.tobytes()
    was_inside = (solutions >= LOWER) & (solutions <= UPPER)
    assert (repaired == solutions)[was_inside].all()


@given(seeds)
def test_the_difference_leads_from_one_to_the_other(seed):
    one, other = BOX.sample(10, rng=rng(seed)), BOX.sample(10, rng=rng(seed + 1))
    assert other + BOX.difference(one, other) == pytest.approx(one)
    assert not BOX.difference(one, one).any()


def test_bounds_are_its_own():
    lower = np.zeros(2)
    box = BoxSpace(lower, [1.0, 1.0])
    lower[:] = 9.0
    assert (box.sample(9, rng=rng()) <= 1.0).all()


@pytest.mark.parametrize(
    ("lower", "upper", "message"),
    [
        ([0.0], [1.0, 2.0], r"of one shape \(dim,\), but got \(1,\) and \(2,\)"),
        (0.0, 1.0, r"got \(\) and \(\)"),
        ([], [], r"got \(0,\) and \(0,\)"),
        ([[0.0]], [[1.0]], r"got \(1, 1\)"),
        ([0.0, 1.0], [1.0, 1.0], r"below the upper ones, but got \[0.0, 1.0\] and"),
        ([0.0], [np.inf], "Expected finite lower bounds"),
        ([-np.inf], [-np.inf], "Expected finite lower bounds"),
        ([np.nan], [1.0], "Expected finite lower bounds"),
        ([-1e308], [1e308], "Expected finite lower bounds"),
    ],
)
def test_bounds_that_make_no_box_are_refused(lower, upper, message):
    with pytest.raises(SpaceError, match=message):
        BoxSpace(lower, upper)


@pytest.mark.parametrize("std", [-0.1, np.nan, np.inf])
def test_a_spread_must_be_a_number_of_at_least_0(std):
    with pytest.raises(SpaceError, match=f"deviation of at least 0 .* got {std}"):
        BoxSpace([0.0], [1.0], std=std)
