"""What random search and the genetic algorithm have in common."""

import dataclasses
import inspect
import io
import pickle
import random

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lqd_search.methods.genetic_algorithm import GeneticAlgorithm
from lqd_search.methods.method import Method, MethodError
from lqd_search.methods.random_search import RandomSearch

PASSIVE = {"expert": ((), np.bool_)}
KINDS = (RandomSearch, GeneticAlgorithm)


def new_method(kind, toy, *, evaluations=100, batch_size=32, seed=0, **options):
    box = {"lower": [0.0] * 3, "upper": [1.0] * 3} if kind is GeneticAlgorithm else {}
    return kind(
        toy,
        evaluations=evaluations,
        batch_size=batch_size,
        rng=np.random.default_rng(seed),
        **({"fitness": "near", "passive_fields": PASSIVE} | box | options),
    )


def finish(method, toy):
    """Go on until all is done, and return the generations' solutions."""
    generations = []
    while not method.done:
        generations.append(method.ask())
        method.tell(toy.evaluate(generations[-1]))
    return generations


def lists(columns):
    return {name: column.tolist() for name, column in columns.items()}


@pytest.fixture(params=KINDS)
def kind(request):
    return request.param


def test_it_has_what_the_protocol_asks_for(kind, toy):
    for name in [name for name in vars(Method) if not name.startswith("_")]:
        wanted, there = getattr(Method, name), getattr(kind, name)
        assert isinstance(there, property) == isinstance(wanted, property)
        if inspect.isfunction(wanted):
            assert inspect.signature(there) == inspect.signature(wanted)
    method = new_method(kind, toy)
    assert (method.archive, method.exploration, method.chosen) == (None, {}, None)


@given(evaluations=st.integers(1, 60), batch_size=st.integers(2, 20), kind=st.sampled_from(KINDS))
@settings(max_examples=40, deadline=None)
def test_exactly_the_budget_is_spent(toy, evaluations, batch_size, kind):
    method = new_method(kind, toy, evaluations=evaluations, batch_size=batch_size)
    sizes = [len(solutions) for solutions in finish(method, toy)]
    full, rest = divmod(evaluations, batch_size)
    assert sizes == [batch_size] * full + [rest] * (rest > 0)
    assert method.evaluations == evaluations
    with pytest.raises(MethodError, match="since all evaluations are spent"):
        method.ask()


def test_the_output_is_what_was_evaluated(kind, toy):
    method = new_method(kind, toy)
    empty = method.output()
    asked = np.concatenate(finish(method, toy))
    output = method.output()
    values = toy.evaluate(output["solution"])
    assert list(output) == ["solution", "objective", "success", "evaluation", "expert"]
    assert (np.diff(output["evaluation"]) > 0).all()
    assert asked[output["evaluation"]].tolist() == output["solution"].tolist()
    assert values.valid.all()
    assert output["objective"].tolist() == values.fitness["near"].tolist()
    assert output["success"].tolist() == values.success.tolist()
    assert output["expert"].tolist() == values.passive["expert"].tolist()
    assert {name: (c.dtype, c.shape[1:]) for name, c in output.items()} == {
        name: (c.dtype, c.shape[1:]) for name, c in empty.items()
    }
    assert len(empty["solution"]) == 0


def test_the_same_seed_gives_the_same_run_and_another_one_another(kind, toy):
    one, two, other = (
        np.concatenate(finish(new_method(kind, toy, seed=s), toy)) for s in (1, 1, 2)
    )
    assert one.tobytes() == two.tobytes()
    assert one.tobytes() != other.tobytes()


def test_global_random_states_are_neither_read_nor_changed(kind, toy):
    def run(seed):
        np.random.seed(seed)  # noqa: NPY002
        random.seed(seed)
        before = repr(np.random.get_state()), random.getstate()  # noqa: NPY002
        generations = finish(new_method(kind, toy), toy)
        assert (repr(np.random.get_state()), random.getstate()) == before  # noqa: NPY002
        return np.concatenate(generations).tobytes()

    assert run(1) == run(2)


@pytest.mark.parametrize("generations", [0, 1, 2, 4])
def test_pickled_in_the_middle_it_goes_on_bit_for_bit(kind, toy, generations):
    method = new_method(kind, toy, evaluations=150)
    for _ in range(generations):
        method.tell(toy.evaluate(method.ask()))
    twin = pickle.loads(pickle.dumps(method))
    assert [s.tobytes() for s in finish(method, toy)] == [s.tobytes() for s in finish(twin, toy)]
    assert lists(method.output()) == lists(twin.output())


def test_its_pickle_holds_arrays_and_a_generator_only(kind, toy):
    method = new_method(kind, toy)
    for _ in range(2):
        method.tell(toy.evaluate(method.ask()))
    modules = set()

    class Recorder(pickle.Unpickler):
        def find_class(self, module, name):
            modules.add(module)
            return super().find_class(module, name)

    Recorder(io.BytesIO(pickle.dumps(method))).load()
    parts = {"lqd_search.methods.told_columns", "lqd_search.methods.turns"}
    own = {kind.__module__, type(toy).__module__, *parts}
    assert {m for m in modules if m.split(".")[0] != "numpy"} == own


def test_after_an_error_in_tell_it_can_be_told_again(kind, toy):
    method, twin = new_method(kind, toy), new_method(kind, toy)
    for _ in range(2):
        method.tell(toy.evaluate(method.ask()))
        twin.tell(toy.evaluate(twin.ask()))
    values = toy.evaluate(method.ask())
    others = {name: values.fitness[name] for name in ("flat", "away")}
    before = method.evaluations, method.stage, lists(method.output())
    with pytest.raises(MethodError, match="Expected the values of 32 solutions, but got 31; pass"):
        method.tell(toy.evaluate(np.zeros((31, 3))))
    with pytest.raises(MethodError, match=r"the fitness 'near' among .* there are only flat, away"):
        method.tell(dataclasses.replace(values, fitness=others))
    with pytest.raises(MethodError, match=r"passive column 'expert' among .* there are only none"):
        method.tell(dataclasses.replace(values, passive={}))
    with pytest.raises(MethodError, match=r"have shape \(32,\) and dtype bool, but .* float64"):
        method.tell(dataclasses.replace(values, passive={"expert": np.zeros(32)}))
    with pytest.raises(MethodError, match=r"but it has \(32, 2\) and bool; convert it"):
        method.tell(dataclasses.replace(values, passive={"expert": np.zeros((32, 2), bool)}))
    assert (method.evaluations, method.stage, lists(method.output())) == before
    method.tell(values)
    twin.tell(toy.evaluate(twin.ask()))
    finish(method, toy)
    finish(twin, toy)
    assert lists(method.output()) == lists(twin.output())


def test_what_was_handed_out_can_be_changed_without_harm(kind, toy):
    method, twin = new_method(kind, toy), new_method(kind, toy)
    while not method.done:
        solutions = method.ask()
        values = toy.evaluate(solutions)
        method.tell(values)
        solutions[:] = 0.0
        for column in (values.fitness["near"], values.valid, values.passive["expert"]):
            column[:] = 0
        for column in method.output().values():
            column[:] = 0
    finish(twin, toy)
    assert lists(method.output()) == lists(twin.output())


def test_ask_and_tell_take_turns(kind, toy):
    method = new_method(kind, toy)
    with pytest.raises(MethodError, match="Expected a call of ask before tell"):
        method.tell(toy.evaluate(np.zeros((32, 3))))
    method.ask()
    with pytest.raises(MethodError, match="since the last ones were not told yet"):
        method.ask()


def test_a_solution_without_fitness_is_put_out_without_an_objective(kind, toy):
    method = new_method(kind, toy)
    while not method.done:
        values = toy.evaluate(method.ask())
        nothing = {"near": np.full(len(values), np.nan)}
        method.tell(dataclasses.replace(values, fitness=nothing))
    output = method.output()
    assert len(output["objective"]) > 0
    assert np.isnan(output["objective"]).all()


def test_what_makes_no_sense_is_refused(kind, toy):
    with pytest.raises(MethodError, match=r"at least 1 evaluation .* but got 0 and 32"):
        new_method(kind, toy, evaluations=0)
    fewest = 2 if kind is GeneticAlgorithm else 1
    with pytest.raises(
        MethodError,
        match=f"batch size of at least {fewest}, but got 100 and {fewest - 1}; raise what",
    ):
        new_method(kind, toy, batch_size=fewest - 1)
    with pytest.raises(MethodError, match="but got 'evaluation'; rename it"):
        new_method(kind, toy, passive_fields={"evaluation": ((), np.int64)})


@pytest.mark.parametrize("evaluations", [1, 2, 5])
def test_the_smallest_batches_will_do(kind, toy, evaluations):
    batch_size = 2 if kind is GeneticAlgorithm else 1
    method = new_method(kind, toy, evaluations=evaluations, batch_size=batch_size)
    asked = np.concatenate(finish(method, toy))
    assert len(np.unique(asked, axis=0)) == len(asked) == evaluations
