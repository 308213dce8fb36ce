import inspect

import numpy as np
import pytest

from lqd_search import LanguageDrivenQD, Method


def members(protocol):
    return {name for name in vars(protocol) if not name.startswith("_")}


@pytest.mark.parametrize("method", [LanguageDrivenQD])
def test_a_method_has_what_the_protocol_asks_for(method):
    for name in members(Method):
        wanted, there = getattr(Method, name), getattr(method, name)
        assert isinstance(there, property) == isinstance(wanted, property)
        if inspect.isfunction(wanted):
            assert inspect.signature(there) == inspect.signature(wanted)


def test_ask_and_tell_are_all_that_a_run_needs(toy):
    method: Method = LanguageDrivenQD(
        toy,
        descriptors=toy.descriptors,
        fitness_names=toy.fitness_names,
        evaluations=320,
        batch_size=16,
        rng=np.random.default_rng(0),
    )
    while not method.done:
        method.tell(toy.evaluate(method.ask()))
    output = method.output()
    assert method.evaluations == 320
    assert {"solution", "objective", "success", "evaluation"} <= set(output)
    assert len({len(column) for column in output.values()}) == 1
