import inspect

import numpy as np
import pytest

from lqd_search import (
    GeneticAlgorithm,
    LanguageDrivenQD,
    MapElitesSuccess,
    Method,
    RandomSearch,
)


def exploring(toy, **sizes):
    return LanguageDrivenQD(
        toy, descriptors=toy.descriptors, fitness_names=toy.fitness_names, **sizes
    )


def searching(toy, **sizes):
    return MapElitesSuccess(toy, descriptors=toy.descriptors, fitness="near", **sizes)


def breeding(toy, **sizes):
    box = {"lower": np.zeros(toy.dim), "upper": np.ones(toy.dim)}
    return GeneticAlgorithm(toy, fitness="near", **box, **sizes)


def sampling(toy, **sizes):
    return RandomSearch(toy, fitness="near", **sizes)


METHODS = [exploring, searching, breeding, sampling]


def members(protocol):
    return {name for name in vars(protocol) if not name.startswith("_")}


@pytest.fixture(params=METHODS, ids=lambda make: make.__name__)
def method(request, toy):
    return request.param(toy, evaluations=330, batch_size=16, rng=np.random.default_rng(0))


def test_a_method_has_what_the_protocol_asks_for(method):
    for name in members(Method):
        wanted, there = getattr(Method, name), getattr(method, name)
        if inspect.isfunction(wanted):
            signature = inspect.signature(getattr(type(method), name))
            assert signature == inspect.signature(wanted)
        else:
            assert not callable(there)


def test_ask_and_tell_are_all_that_a_run_needs(method: Method, toy):
    asked = []
    while not method.done:
        asked.append(method.ask())
        method.tell(toy.evaluate(asked[-1]))

    assert [len(solutions) for solutions in asked] == [16] * 20 + [10]
    assert method.evaluations == 330
    output = method.output()
    assert {"solution", "objective", "success", "evaluation"} <= set(output)
    assert len({len(column) for column in output.values()}) == 1
    told = np.concatenate(asked)
    np.testing.assert_array_equal(output["solution"], told[output["evaluation"]])
    assert len(np.unique(output["solution"], axis=0)) == len(output["solution"])


def test_the_first_generation_is_uniformly_random(method: Method, toy):
    first = method.ask()

    assert first.shape == (16, toy.dim)
    assert ((first >= 0.0) & (first <= 1.0)).all()
