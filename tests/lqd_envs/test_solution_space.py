import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.spatial.transform import Rotation
from scipy.stats import kstest

from lqd_envs import LQDError, SolutionError, SolutionSpace

SPACE = SolutionSpace()
QUARTER_TURN = np.pi / 2
JUST_BELOW_PI = np.nextafter(np.pi, 0.0)
REPEATABLE = settings(deadline=None, derandomize=True, max_examples=200)

seeds = st.integers(0, 2**32 - 1)
counts = st.integers(0, 40)
some_solutions = arrays(np.float64, (5, 9), elements=st.floats(-10.0, 10.0))
any_solutions = arrays(
    np.float64, (5, 9), elements=st.floats(allow_nan=False, allow_infinity=False)
)
angles = arrays(np.float64, (3,), elements=st.floats(-1e3, 1e3))


@st.composite
def feasible_solutions(draw):
    """One solution of the space, its borders and signed zeros included."""
    position = [draw(st.floats(-1.0, 1.0)) for _ in range(3)]
    tilts = [draw(st.floats(-QUARTER_TURN, QUARTER_TURN)) for _ in range(2)]
    yaw = draw(st.floats(-np.pi, JUST_BELOW_PI))
    motion = [draw(st.floats(-1.0, 1.0)), draw(st.floats(-1.0, 1.0)), draw(st.floats(-0.0, 1.0))]
    assume(0.25 <= np.sqrt(motion[0] ** 2 + motion[1] ** 2 + motion[2] ** 2) <= 1.0)
    return np.array([[*position, *tilts, yaw, *motion]])


def assert_in_space(solutions):
    """Check the space as the documentation states it, up to the rounding of a length."""
    assert np.all(np.abs(solutions[:, 0:3]) <= 1.0)
    assert np.all(np.abs(solutions[:, 3:5]) <= QUARTER_TURN)
    assert np.all((solutions[:, 5] >= -np.pi) & (solutions[:, 5] < np.pi))
    assert np.all(solutions[:, 8] >= 0.0)
    length = np.linalg.norm(solutions[:, 6:9], axis=1)
    assert np.all((length > 0.25 - 1e-12) & (length < 1.0 + 1e-12))
    assert SPACE.feasible(solutions).all()


@REPEATABLE
@given(n=counts, seed=seeds)
def test_sample_is_feasible(n, seed):
    solutions = SPACE.sample(n, rng=np.random.default_rng(seed))

    assert solutions.shape == (n, 9)
    assert solutions.dtype == np.float64
    assert_in_space(solutions)


@REPEATABLE
@given(parents=any_solutions, seed=seeds)
def test_mutant_is_feasible(parents, seed):
    mutants = SPACE.mutate(parents, rng=np.random.default_rng(seed))

    assert mutants.shape == parents.shape
    assert_in_space(mutants)


@REPEATABLE
@given(solutions=some_solutions)
def test_repaired_is_feasible(solutions):
    assert_in_space(SPACE.repair(solutions))


@REPEATABLE
@given(solutions=any_solutions)
@example(solutions=np.full((5, 9), 1e300))
@example(solutions=np.full((5, 9), -1e300))
@example(solutions=np.full((5, 9), 1e-300))
@example(solutions=np.full((5, 9), -1e-300))
@example(solutions=np.full((5, 9), np.finfo(np.float64).max))
@example(solutions=np.full((5, 9), 5e-324))
def test_every_finite_number_is_repaired_without_a_warning(solutions):
    with np.errstate(over="raise", invalid="raise", divide="raise"):
        repaired = SPACE.repair(solutions)

    assert_in_space(repaired)


@REPEATABLE
@given(solutions=any_solutions)
def test_repair_is_idempotent(solutions):
    once = SPACE.repair(solutions)

    assert SPACE.repair(once).tobytes() == once.tobytes()


@REPEATABLE
@given(solution=feasible_solutions())
@example(solution=np.array([[1.0, -1.0, -0.0, QUARTER_TURN, -QUARTER_TURN, -np.pi, 0.25, 0, 0]]))
@example(solution=np.array([[-0.0, 0, -0.0, -0.0, -0.0, JUST_BELOW_PI, -0.0, -1.0, -0.0]]))
@example(solution=np.array([[0, 0, 0, -5e-324, 5e-324, -1e-300, 1e-300, -0.0, 1.0]]))
def test_feasible_is_left_alone_bit_for_bit(solution):
    assert SPACE.feasible(solution).all()
    assert SPACE.repair(solution).tobytes() == solution.tobytes()


def test_repair_leaves_its_argument_alone():
    solutions = np.full((2, 9), 7.0)

    SPACE.repair(solutions)

    assert np.array_equal(solutions, np.full((2, 9), 7.0))


@REPEATABLE
@given(rpy=angles)
@example(rpy=np.array([3.0, 3.0, 3.0]))
@example(rpy=np.array([-2.0, 1.6, -3.0]))
@example(rpy=np.array([0.0, -np.pi, 0.0]))
def test_repair_keeps_a_rotation_that_does_not_point_up(rpy):
    rotation = Rotation.from_euler("xyz", rpy)
    # The gripper's z axis points back from its fingers: not below the horizontal is in the space.
    upwards = rotation.as_matrix()[2, 2]
    assume(abs(upwards) > 1e-6)

    repaired = SPACE.repair([[0, 0, 0, *rpy, 0, 0, 1]])[0, 3:6]

    after = Rotation.from_euler("xyz", repaired)
    if upwards > 0.0:
        assert (after * rotation.inv()).magnitude() < 1e-9
    else:
        assert abs(repaired[0]) == QUARTER_TURN
        assert abs(after.as_matrix()[2, 2]) < 1e-9


@pytest.mark.parametrize(
    ("motion", "repaired"),
    [
        ((0.0, 0.0, 0.0), (0.0, 0.0, 0.25)),
        ((0.0, 0.0, -0.5), (0.0, 0.0, 0.25)),
        ((0.1, 0.0, -3.0), (0.25, 0.0, 0.0)),
        ((3.0, 0.0, 4.0), (0.6, 0.0, 0.8)),
        ((-1e200, 0.0, 0.0), (-1.0, 0.0, 0.0)),
        ((0.0, 1e-200, 0.0), (0.0, 0.25, 0.0)),
        ((0.0, 0.5, -1e-9), (0.0, 0.5, 0.0)),
    ],
)
def test_motion_is_clipped_at_the_horizontal_then_in_length(motion, repaired):
    (solution,) = SPACE.repair([[0, 0, 0, 0, 0, 0, *motion]])

    assert solution[6:9] == pytest.approx(repaired, abs=1e-12)


@pytest.mark.parametrize("yaw", [-np.pi, np.nextafter(-np.pi, -4.0), np.pi, -3 * np.pi, 1e17])
def test_yaw_is_wrapped_into_its_half_open_range(yaw):
    (solution,) = SPACE.repair([[0, 0, 0, 0, 0, yaw, 0, 0, 1]])

    assert -np.pi <= solution[5] < np.pi


def test_position_is_clipped():
    (solution,) = SPACE.repair([[-7, 0.5, 1.0001, 0, 0, 0, 0, 0, 1]])

    assert solution[:3].tolist() == [-1.0, 0.5, 1.0]


@pytest.fixture(scope="module")
def sampled():
    return SPACE.sample(20_000, rng=np.random.default_rng(5))


def assert_uniform(values, low, high):
    # One time in a thousand a uniform sample exceeds this; the seed is fixed.
    bound = 1.95 / np.sqrt(len(values))
    assert kstest((values - low) / (high - low), "uniform").statistic < bound


@pytest.mark.parametrize("column", [0, 1, 2])
def test_sampled_positions_are_uniform(sampled, column):
    assert_uniform(sampled[:, column], -1.0, 1.0)


def test_sampled_rotations_are_uniform_over_the_half_sphere(sampled):
    roll, pitch, yaw = sampled[:, 3:6].T
    assert_uniform(np.sin(pitch), -1.0, 1.0)
    assert_uniform(roll, -QUARTER_TURN, QUARTER_TURN)
    assert_uniform(yaw, -np.pi, np.pi)

    fingers = -Rotation.from_euler("xyz", sampled[:, 3:6]).as_matrix()[:, :, 2]
    assert_uniform(fingers[:, 2], -1.0, 0.0)
    assert_uniform(np.arctan2(fingers[:, 1], fingers[:, 0]), -np.pi, np.pi)


def test_sampled_motions_are_uniform_in_direction_and_length(sampled):
    motion = sampled[:, 6:9]
    length = np.linalg.norm(motion, axis=1)
    assert_uniform(length, 0.25, 1.0)
    assert_uniform(motion[:, 2] / length, 0.0, 1.0)
    assert_uniform(np.arctan2(motion[:, 1], motion[:, 0]), -np.pi, np.pi)


def test_sampled_numbers_do_not_depend_on_each_other(sampled):
    free = np.column_stack([sampled[:, :6], np.linalg.norm(sampled[:, 6:9], axis=1)])
    correlation = np.corrcoef(free.T) - np.eye(free.shape[1])

    assert np.abs(correlation).max() < 5 / np.sqrt(len(sampled))


def test_mutation_has_the_documented_spread():
    parent = np.array([[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.65]])
    space = SolutionSpace(position_std=0.15, orientation_std=0.3, motion_std=0.02)

    mutants = space.mutate(np.repeat(parent, 20_000, axis=0), rng=np.random.default_rng(6))

    stds = [0.15] * 3 + [0.3] * 3 + [0.02] * 3
    assert (mutants - parent).std(axis=0) == pytest.approx(stds, rel=0.03)


def test_same_seed_gives_the_same_solutions():
    def draw():
        rng = np.random.default_rng(7)
        return SPACE.mutate(SPACE.sample(50, rng=rng), rng=rng).tobytes()

    assert draw() == draw()


@pytest.mark.parametrize(
    "outside",
    [
        {0: 1.0001},
        {2: -1.5},
        {3: 1.6},
        {4: -1.6},
        {5: np.pi},
        {5: -3.2},
        {8: -1e-9},
        {8: 0.2},
        {8: 1.1},
    ],
)
def test_infeasible_is_found(outside):
    solution = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.5])
    assert SPACE.feasible(solution[None]).tolist() == [True]

    solution[list(outside)] = list(outside.values())

    assert SPACE.feasible(solution[None]).tolist() == [False]


METHODS = {
    "validate": SPACE.validate,
    "repair": SPACE.repair,
    "feasible": SPACE.feasible,
    "mutate": lambda solutions: SPACE.mutate(solutions, rng=np.random.default_rng(0)),
}


@pytest.mark.parametrize("method", METHODS.values(), ids=METHODS)
@pytest.mark.parametrize(
    ("solutions", "text"),
    [
        (np.zeros(9), r"expected solutions of shape \(n, 9\), got \(9,\): pass one row \[x, y, z"),
        (np.zeros((2, 8)), r"expected solutions of shape \(n, 9\), got \(2, 8\)"),
        (np.zeros((1, 1, 9)), r"expected solutions of shape \(n, 9\), got \(1, 1, 9\)"),
        ("wave", r"shape \(n, 9\), got something that is not an array of numbers \(could not"),
        ([["a"] * 9], r"not an array of numbers .*dz\] for each motion"),
        ([[1.0], [1.0, 2.0]], r"not an array of numbers .*inhomogeneous"),
        (
            [[0.0] * 9, [0.0] * 4 + [np.nan] + [0.0] * 4],
            r"expected finite numbers, got nan for pitch of solution 1: remove or repair",
        ),
        ([[0.0] * 8 + [-np.inf]], r"expected finite numbers, got -inf for dz of solution 0"),
    ],
)
def test_what_is_wrong_with_solutions_is_said(method, solutions, text):
    with pytest.raises(SolutionError, match=text) as caught:
        method(solutions)

    assert isinstance(caught.value, LQDError)
    assert isinstance(caught.value, ValueError)


def test_validate_returns_an_array_of_floats():
    checked = SPACE.validate([[1] * 9])

    assert checked.dtype == np.float64
    assert checked.tolist() == [[1.0] * 9]
    assert SPACE.validate(np.zeros((0, 9))).shape == (0, 9)


def test_solution_has_nine_numbers():
    assert SPACE.dim == 9


def test_the_bounds_are_those_of_the_box_around_the_space():
    assert SPACE.lower.shape == SPACE.upper.shape == (SPACE.dim,)
    solutions = SPACE.sample(20_000, rng=np.random.default_rng(0))
    assert ((solutions >= SPACE.lower) & (solutions <= SPACE.upper)).all()
    # The box is no wider than it must be, wherever samples come close to its sides.
    width = SPACE.upper - SPACE.lower
    assert (solutions.min(axis=0) - SPACE.lower < 0.05 * width).all()
    assert (SPACE.upper - solutions.max(axis=0) < 0.05 * width).all()


def test_the_bounds_are_new_arrays_each_time():
    SPACE.lower[:] = 9.0
    SPACE.upper[:] = 9.0
    assert SPACE.lower[0] == -1.0
    assert SPACE.upper[0] == 1.0


@given(seed=seeds)
def test_the_difference_leads_from_one_solution_to_the_other(seed):
    generator = np.random.default_rng(seed)
    one, other = SPACE.sample(20, rng=generator), SPACE.sample(20, rng=generator)
    difference = SPACE.difference(one, other)
    np.testing.assert_allclose(SPACE.repair(other + difference), one, atol=1e-12)
    np.testing.assert_allclose(difference, -SPACE.difference(other, one), atol=1e-12)
    assert not SPACE.difference(one, one).any()


@pytest.mark.parametrize(
    ("yaw", "other", "way"),
    [
        (0.5, -0.5, 1.0),
        (3.0, -3.0, 6.0 - 2 * np.pi),
        (-3.0, 3.0, 2 * np.pi - 6.0),
        (np.pi / 2, -np.pi / 2, -np.pi),
    ],
)
def test_the_difference_in_yaw_is_the_shorter_way_round(yaw, other, way):
    one, two = np.zeros((2, 1, 9))
    one[0, 5], two[0, 5] = yaw, other
    assert SPACE.difference(one, two)[0, 5] == pytest.approx(way)
    assert not np.delete(SPACE.difference(one, two), 5).any()


def test_differences_are_of_solutions():
    with pytest.raises(SolutionError, match=r"expected solutions of shape \(n, 9\), got \(9,\)"):
        SPACE.difference(np.zeros((1, 9)), np.zeros(9))
