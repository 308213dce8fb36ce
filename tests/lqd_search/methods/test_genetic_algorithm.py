import pickle
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pymoo.algorithms.soo.nonconvex.ga import GA
from pymoo.core.problem import Problem
from pymoo.core.repair import Repair

import lqd_envs
from lqd_search import Values
from lqd_search.methods.genetic_algorithm import GeneticAlgorithm
from lqd_search.methods.method import MethodError
from lqd_search.methods.random_search import RandomSearch

HALF_TURN = np.pi
MOTION_BOX = {
    "lower": [-1.0] * 3 + [-HALF_TURN / 2.0] * 2 + [-HALF_TURN] + [-1.0, -1.0, 0.0],
    "upper": [1.0] * 3 + [HALF_TURN / 2.0] * 2 + [HALF_TURN] + [1.0] * 3,
}


def new_method(space, *, evaluations=320, batch_size=32, seed=0, fitness="near", **options):
    return GeneticAlgorithm(
        space,
        fitness=fitness,
        evaluations=evaluations,
        batch_size=batch_size,
        rng=np.random.default_rng(seed),
        **({"lower": [0.0] * 3, "upper": [1.0] * 3} | options),
    )


def values_of(fitness, *, valid=None):
    valid = np.ones(len(fitness), bool) if valid is None else valid
    return Values(valid=valid, success=~valid & False, fitness={"near": fitness}, measures={})


def finish(method, evaluate):
    generations = []
    while not method.done:
        generations.append(method.ask())
        method.tell(evaluate(generations[-1]))
    return np.concatenate(generations)


def coarse(solutions):
    return np.round(solutions * 20.0) / 20.0


def partly_undefined(solutions):
    """A fitness of which a third is undefined and a third of a failed solution, the best ones."""
    fitness = -np.square(solutions - 0.4).sum(axis=1)
    fitness[solutions[:, 0] > 2.0 / 3.0] = np.nan
    failed = solutions[:, 0] < 1.0 / 3.0
    fitness[failed] += 1e6
    return values_of(fitness, valid=~failed)


class TheirRepair(Repair):
    def _do(self, _problem, solutions, **_):
        return coarse(solutions)


@pytest.mark.parametrize("repair", [None, coarse])
def test_generations_are_those_of_pymoos_own_algorithm(toy, repair):
    method = new_method(toy, repair=repair)
    rng = np.random.default_rng(0)
    theirs = GA(pop_size=32, sampling=toy.sample(32, rng=rng))
    theirs.setup(Problem(n_var=3, n_obj=1, n_ieq_constr=1, xl=np.zeros(3), xu=np.ones(3)))
    theirs.random_state = rng
    theirs.mating.repair = TheirRepair() if repair else theirs.mating.repair
    for _ in range(10):
        solutions, individuals = method.ask(), theirs.ask()
        assert solutions.tobytes() == individuals.get("X").tobytes()
        values = partly_undefined(solutions)
        method.tell(values)
        unfit = ~values.valid | np.isnan(values.fitness["near"])
        individuals.set("F", np.where(unfit, 0.0, -values.fitness["near"])[:, None])
        individuals.set("G", unfit[:, None].astype(float))
        theirs.tell(infills=individuals)


def test_it_does_better_than_random_search(toy):
    method = new_method(toy, evaluations=640)
    random = RandomSearch(
        toy, fitness="near", evaluations=640, batch_size=32, rng=np.random.default_rng(0)
    )
    finish(method, toy.evaluate)
    finish(random, toy.evaluate)
    best = np.sort(random.output()["objective"])[-32:]
    assert len(method.output()["objective"]) == 32
    assert method.output()["objective"].mean() > best.mean()
    assert method.output()["objective"].max() > best.max()
    assert method.output()["success"].all()


@given(evaluations=st.integers(2, 150), seed=st.integers(0, 99))
@settings(max_examples=25, deadline=None)
def test_the_fittest_survive(toy, evaluations, seed):
    method = new_method(toy, evaluations=evaluations, batch_size=16, seed=seed)
    values = toy.evaluate(finish(method, toy.evaluate))
    best = np.sort(values.fitness["near"][values.valid])[-16:]
    assert sorted(method.output()["objective"]) == best.tolist()


def test_a_condition_plays_no_part(toy):
    def without_success(solutions):
        return values_of(
            toy.evaluate(solutions).fitness["near"], valid=toy.evaluate(solutions).valid
        )

    one, two = new_method(toy), new_method(toy)
    assert finish(one, toy.evaluate).tobytes() == finish(two, without_success).tobytes()
    assert one.output()["success"].any()
    assert not two.output()["success"].any()


def test_failed_and_undefined_solutions_are_behind_the_worst(toy):
    def evaluate(solutions):
        values = partly_undefined(solutions)
        fine = values.valid & ~np.isnan(values.fitness["near"])
        lowest = np.where(fine, -1e300 * solutions[:, 1], values.fitness["near"])
        return values_of(lowest, valid=values.valid)

    method = new_method(toy)
    values = evaluate(finish(method, evaluate))
    output = method.output()
    assert 32 < (values.valid & ~np.isnan(values.fitness["near"])).sum() < 320
    assert len(output["objective"]) == 32
    assert (output["objective"] <= 0.0).all()


@pytest.mark.parametrize("undefined", [False, True])
def test_where_nothing_is_fit_the_search_goes_on(toy, undefined):
    def evaluate(solutions):
        n = len(solutions)
        return values_of(np.full(n, np.nan if undefined else 1.0), valid=np.full(n, undefined))

    method = new_method(toy)
    asked = finish(method, evaluate)
    assert len(np.unique(asked, axis=0)) == 320
    assert ((asked >= 0.0) & (asked <= 1.0)).all()
    # A tie goes to the parents.
    kept = list(range(32)) if undefined else []
    assert method.output()["evaluation"].tolist() == kept


def test_what_is_asked_for_is_repaired_and_new():
    space = lqd_envs.SolutionSpace()
    method = new_method(space, repair=space.repair, **MOTION_BOX)
    asked = finish(method, lambda solutions: values_of(solutions[:, 8]))
    assert space.feasible(asked).all()
    assert len(np.unique(asked, axis=0)) == 320
    assert asked[method.output()["evaluation"]].tolist() == method.output()["solution"].tolist()


def test_what_duplicates_leave_open_is_sampled(toy):
    def to_a_corner(solutions):
        return np.round(solutions)

    method = new_method(toy, evaluations=64, repair=to_a_corner)
    asked = finish(method, lambda solutions: values_of(solutions[:, 0]))
    corners = (asked == np.round(asked)).all(axis=1)
    # There are eight of them, and each is new once.
    assert 0 < corners[32:].sum() <= 8
    assert len(np.unique(asked, axis=0)) == 64


def test_memory_does_not_grow_with_the_generations(toy):
    def sizes(evaluations):
        method = new_method(toy, evaluations=evaluations)
        finish(method, toy.evaluate)
        return len(pickle.dumps(method))

    assert sizes(64) == pytest.approx(sizes(64 * 32), abs=64)


def test_the_stage_says_which_generation_it_is(toy):
    method = new_method(toy, evaluations=70)
    stages = [method.stage]
    while not method.done:
        method.tell(toy.evaluate(method.ask()))
        stages.append(method.stage)
    assert stages == [f"generation {i} of 3" for i in (1, 2, 3, 3)]


@pytest.mark.parametrize(
    "bounds",
    [
        {"lower": [0.0, 0.0]},
        {"upper": [1.0, 1.0, -1.0]},
        {"upper": [1.0, 1.0, np.inf]},
        {"lower": [np.nan, 0.0, 0.0]},
    ],
)
def test_bounds_without_sense_are_refused(toy, bounds):
    with pytest.raises(MethodError, match="Expected 3 finite lower bounds and as many upper ones"):
        new_method(toy, **bounds)


def test_a_number_without_room_stays_as_it_is(toy):
    method = new_method(toy, lower=[0.0, 0.0, 0.5], upper=[1.0, 1.0, 0.5], repair=half_way)
    asked = finish(method, toy.evaluate)
    assert (asked[32:, 2] == 0.5).all()


def half_way(solutions):
    return np.column_stack([solutions[:, :2], np.full(len(solutions), 0.5)])


def test_importing_the_package_does_not_import_pymoo():
    code = "import sys, lqd_search; sys.exit('pymoo' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
