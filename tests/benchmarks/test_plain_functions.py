import math

import pytest

from benchmarks.plain_functions import plain_direct_functionals, plain_function, plain_functionals
from lqd_envs import LQDError
from lqd_search.runs.function_text import FunctionText


def test_math_np_helpers_and_constants_are_there():
    code = (
        "SCALE = 2.0\n"
        "def fitness(info): return SCALE * half(math.hypot(*info)) + float(np.sum(info))\n"
        "def half(x): return x / 2"
    )

    assert plain_function(code, entry="fitness")((3.0, 4.0)) == 12.0


def test_annotations_need_not_exist():
    code = (
        "LIMIT: Meters = 0.5\n"
        "unset: Nothing\n"
        "def fitness(info: Info, *rest: Rest, k: Key = 1) -> Missing[int]:\n"
        "    inner: Inner = LIMIT\n"
        "    return inner\n"
    )

    assert plain_function(code, entry="fitness")(None) == 0.5


def test_no_function_has_the_names_of_another():
    first = plain_function("SECRET = 3\ndef fitness(info): return SECRET", entry="fitness")
    second = plain_function("def fitness(info): return SECRET", entry="fitness")
    rebinding = plain_function("math = 3\ndef fitness(info): return math", entry="fitness")

    assert (first({}), rebinding({})) == (3, 3)
    with pytest.raises(NameError, match="SECRET"):
        second({})
    assert plain_function("def f(info): return math.pi", entry="f")({}) == math.pi


@pytest.mark.parametrize("code", ["", "fitness = 3", "def score(info): return 0.0"])
def test_code_without_the_function_is_an_error(code):
    with pytest.raises(LQDError) as caught:
        plain_function(code, entry="fitness")

    assert str(caught.value) == (
        "Expected code that defines a function 'fitness', but it does not; correct the code."
    )


def text(kind, name, value):
    entry = kind.rpartition(".")[2]
    return FunctionText(kind, name, "", f"def {entry}(_): return {value!r}")


TEXTS = [
    text("success", "success", value=True),
    text("fitness", "low", 1.0),
    text("fitness", "high", 2.0),
    text("timestamp", "never", None),
    text("quantity", "place", (1.0, 2.0)),
    text("direct.success", "success", value=False),
    text("direct.fitness", "fitness", 3.0),
    text("direct.descriptor", "descriptor", (3.0, 4.0)),
]


def test_functionals_of_a_mesh():
    functionals = plain_functionals(TEXTS)

    assert functionals.success([]) is True
    assert {name: call({}) for name, call in functionals.fitness.items()} == {
        "low": 1.0,
        "high": 2.0,
    }
    assert {name: call([]) for name, call in functionals.timestamps.items()} == {"never": None}
    assert functionals.quantities["place"]({}) == (1.0, 2.0)


def test_direct_functionals():
    functionals = plain_direct_functionals(TEXTS)

    assert functionals.success([]) is False
    assert functionals.fitness({}) == 3.0
    assert functionals.descriptor([]) == (3.0, 4.0)
