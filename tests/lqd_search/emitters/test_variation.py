import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import lqd_envs
from lqd_search.emitters.evolution_emitter import EvolutionEmitter
from lqd_search.emitters.variation import Mutation, SuccessLine
from lqd_search.solution_space import BoxSpace, SpaceError

STILL = BoxSpace([-100.0, -100.0], [100.0, 100.0], std=0.0)
MOTIONS = lqd_envs.SolutionSpace()


def elites_of(solutions, success):
    return {"solution": np.array(solutions, float), "success": np.array(success, bool)}


def rng(seed=0):
    return np.random.default_rng(seed)


class Plain:
    """A space that can do no more than every space."""

    dim = 2

    def sample(self, n, *, rng):
        return rng.random((n, 2))

    def mutate(self, parents, *, rng):
        return parents + rng.random(parents.shape)


class Shifting:
    """A space that marks what it mutated."""

    dim = 2

    def __init__(self, by):
        self.by = by

    def sample(self, n, *, rng):  # noqa: ARG002 -- the protocol's
        raise AssertionError("nothing was to be sampled")

    def mutate(self, parents, *, rng):  # noqa: ARG002 -- the protocol's
        return parents + self.by

    def difference(self, solutions, others):
        return solutions - others


def test_mutation_mutates_each_parent(toy):
    elites = elites_of(np.random.default_rng(1).random((5, 3)), [0, 1, 0, 1, 0])
    parents = np.array([3, 3, 0])
    children = Mutation(toy)(elites, parents, rng=rng())
    assert np.array_equal(children, toy.mutate(elites["solution"][parents], rng=rng()))


def test_children_of_successes_lie_on_lines_to_other_successes():
    elites = elites_of([[0, 0], [10, 0], [50, 60]], [1, 1, 0])
    children = SuccessLine(STILL, STILL)(elites, np.zeros(4000, int), rng=rng())
    assert (children[:, 1] == 0.0).all()
    along = children[:, 0] / 10.0
    drawn_itself = (along == 0.0).mean()
    assert 0.45 < drawn_itself < 0.55
    assert along[along != 0.0].mean() == pytest.approx(0.0, abs=0.02)
    assert along[along != 0.0].std() == pytest.approx(0.2, abs=0.01)


@pytest.mark.parametrize(
    ("make", "name"),
    [(lambda space: SuccessLine(STILL, space), "difference"), (EvolutionEmitter, "repair")],
)
def test_a_space_that_cannot_do_enough_is_refused_at_once(make, name):
    with pytest.raises(SpaceError, match=rf"with the method {name}\(\), but Plain has none; write"):
        make(Plain())


def test_points_on_lines_are_mutated_finely_and_failures_are_not():
    elites = elites_of([[0, 0], [0, 0], [1, 1]], [1, 1, 0])
    line = SuccessLine(near=Shifting(0.5), far=Shifting(7.0))
    children = line(elites, np.array([0, 2, 1]), rng=rng())
    assert children.tolist() == [[0.5, 0.5], [8.0, 8.0], [0.5, 0.5]]


@pytest.mark.parametrize("success", [[0, 0], [1, 0]])
def test_without_another_success_children_are_plain_mutants(success):
    elites = elites_of([[0, 0], [1, 1]], success)
    line = SuccessLine(near=Shifting(0.5), far=Shifting(7.0))
    assert line(elites, np.array([0, 1, 0]), rng=rng()).tolist() == [[7, 7], [8, 8], [7, 7]]


def test_no_parents_have_no_children():
    elites = elites_of([[0, 0], [1, 1]], [1, 1])
    assert SuccessLine(STILL, STILL)(elites, np.empty(0, int), rng=rng()).shape == (0, 2)


def test_on_motions_the_line_takes_the_short_way_round():
    one, other = np.zeros((2, 9))
    one[5], other[5] = 3.0, -3.0
    one[8] = other[8] = 0.5
    still = lqd_envs.SolutionSpace(position_std=0.0, orientation_std=0.0, motion_std=0.0)
    line = SuccessLine(near=still, far=still)
    children = line(elites_of([one, other], [1, 1]), np.zeros(500, int), rng=rng())
    # The two are 0.28 rad apart, through half a turn.
    way = np.mod(children[:, 5] - 3.0 + np.pi, 2 * np.pi) - np.pi
    assert np.abs(way).max() < 0.2832 * 0.2 * 5
    assert way.std() > 0.01
    assert still.feasible(children).all()


@settings(max_examples=30, deadline=None)
@given(st.integers(1, 12), st.integers(0, 12), st.integers(0, 99))
def test_whatever_the_grid_holds_children_are_feasible(size, n, seed):
    generator = np.random.default_rng(seed)
    elites = elites_of(MOTIONS.sample(size, rng=generator), generator.random(size) < 0.5)
    parents = generator.integers(size, size=n)
    line = SuccessLine(near=MOTIONS, far=MOTIONS)
    children = line(elites, parents, rng=rng(seed))
    assert children.shape == (n, 9)
    assert MOTIONS.feasible(children).all()
    assert np.array_equal(children, line(elites, parents, rng=rng(seed)))
