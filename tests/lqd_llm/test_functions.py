import math
import traceback

import numpy as np
import pytest

from lqd_llm import FunctionSource, build_function
from lqd_llm.errors import FunctionError


def build(code: str, *, name: str = "reach", entry: str = "fitness"):
    source = FunctionSource(name=name, description="how near", code=code)
    return build_function(source, kind="fitness", entry=entry)


def test_built_function_keeps_its_source():
    code = "def fitness(info):\n    return 2.0 * info\n"
    function = build(code)

    assert (function.name, function.description, function.code) == ("reach", "how near", code)
    assert function.entry == "fitness"
    assert function.call(3.0) == 6.0


def test_math_and_np_are_there():
    function = build("def fitness(info): return math.hypot(*info) + float(np.sum(info))")

    assert function.call((3.0, 4.0)) == 12.0


def test_helpers_and_constants_are_there():
    code = "SCALE = 2.0\ndef fitness(info): return SCALE * half(info)\ndef half(x): return x / 2"

    assert build(code).call(3.0) == 3.0


def test_annotations_need_not_exist():
    code = (
        "LIMIT: Meters = 0.5\n"
        "unset: Nothing\n"
        "def fitness(info: Info, *rest: Rest, k: Key = 1, **more: More) -> Missing[int]:\n"
        "    inner: Inner = LIMIT\n"
        "    later: Later\n"
        "    def helper(x: X, /) -> Y: return x\n"
        "    return helper(inner)\n"
    )
    function = build(code)

    assert function.call(None) == 0.5
    assert function.call.__annotations__ == {}


@pytest.mark.parametrize(
    "arguments", ["info", "info, /", "info, scale=1.0", "info=None", "*infos", "info, *, k=1"]
)
def test_one_positional_argument_is_enough(arguments):
    assert build(f"def fitness({arguments}): return 1.0").call({}) == 1.0


@pytest.mark.parametrize(
    ("code", "reason"),
    [
        ("def fitness(info):\n    return (\n", "line 2: '(' was never closed"),
        ("x = 1\nreturn x", "line 2: 'return' outside function"),
        ("def fitness(info): return 1\0", "source code string cannot contain null bytes"),
        (
            "def fitness(info):\n    import os\n    return 0.0",
            "line 2: expected no import, since math and np are there already, got 'import os'",
        ),
        (
            "from math import tau\ndef fitness(info): return tau",
            "line 1: expected no import, since math and np are there already, "
            "got 'from math import tau'",
        ),
        ("", "expected a top-level function named 'fitness', got none"),
        (
            "def score(info): return 0.0\ndef fit(info): return 0.0",
            "expected a top-level function named 'fitness', got score, fit",
        ),
        (
            "fitness = lambda info: 0.0",
            "expected a top-level function named 'fitness', got none",
        ),
        (
            "\ndef fitness(info, scale): return 0.0",
            "line 2: expected 'fitness' to take one positional argument, got fitness(info, scale)",
        ),
        (
            "def fitness(): return 0.0",
            "line 1: expected 'fitness' to take one positional argument, got fitness()",
        ),
        (
            "def fitness(info, *, k): return 0.0",
            "line 1: expected 'fitness' to take one positional argument, got fitness(info, *, k)",
        ),
        (
            "def fitness(info): return 0.0\nx = 1\ny = x / 0",
            "line 3: ZeroDivisionError: division by zero, while it was defined",
        ),
        (
            "def start():\n    return open('x')\ndef fitness(info): return 0.0\nf = start()",
            "line 2: NameError: name 'open' is not defined, while it was defined",
        ),
        (
            "def fitness(info): return 0.0\nraise ValueError('two\\n lines')",
            "line 2: ValueError: two lines, while it was defined",
        ),
        (
            "def fitness(info): return 0.0\nraise KeyError",
            "line 2: KeyError, while it was defined",
        ),
        (
            "def fitness(info): return 0.0\nfitness = 3",
            "expected 'fitness' to be a function once the code has run, got 3",
        ),
        (
            "def fitness(info): return 0.0\ndel fitness",
            "expected 'fitness' to be a function once the code has run, got None",
        ),
    ],
)
def test_error_names_function_kind_line_and_reason(code, reason):
    with pytest.raises(FunctionError) as caught:
        build(code)

    assert str(caught.value) == (
        f"The fitness function 'reach' cannot be built: {reason}; "
        "correct its code or take another reply."
    )


def test_code_nested_too_deeply_is_an_error():
    code = "def fitness(info): return 1" + "+1" * 20_000

    with pytest.raises(FunctionError, match=r"'reach' cannot be built: (Recursion|Memory)Error"):
        build(code)


@pytest.mark.parametrize(
    "name",
    ["open", "__import__", "eval", "exec", "compile", "getattr", "globals", "print", "input"],
)
def test_other_builtins_are_not_there(name):
    function = build(f"def fitness(info): return {name}('1')")

    with pytest.raises(NameError, match=f"name '{name}' is not defined"):
        function.call({})


def test_globals_are_not_shared():
    first = build("SECRET = 3\ndef helper(): return SECRET\ndef fitness(info): return helper()")
    second = build("def fitness(info): return SECRET", name="other")
    third = build("def fitness(info): return helper()", name="third")

    assert first.call({}) == 3
    with pytest.raises(NameError, match="SECRET"):
        second.call({})
    with pytest.raises(NameError, match="helper"):
        third.call({})


@pytest.mark.parametrize(
    "rebinding",
    [
        "max = min\ndef fitness(info): return max(info)",
        "__builtins__['max'] = min\ndef fitness(info): return max(info)",
        "def fitness(info):\n    global max, math\n    max = math = min\n    return max(info)",
    ],
)
def test_rebinding_a_name_affects_no_other_function(rebinding):
    before = build("def fitness(info): return max(info)")
    rebinder = build(rebinding, name="rebinder")

    assert rebinder.call([1.0, 2.0]) == 1.0
    after = build("def fitness(info): return max(info) + math.floor(0.5)")
    assert [function.call([1.0, 2.0]) for function in (before, after)] == [2.0, 2.0]
    assert max([1.0, 2.0]) == 2.0
    assert math.floor(0.5) == 0


def test_what_it_raises_comes_from_its_own_file():
    function = build("def fitness(info):\n    return info['none']", name="first_contact")

    with pytest.raises(KeyError) as caught:
        function.call({})

    frame = traceback.extract_tb(caught.value.__traceback__)[-1]
    assert (frame.filename, frame.lineno) == ("<functional first_contact>", 2)


def test_common_builtins_are_there():
    code = (
        "def fitness(info):\n"
        "    try:\n"
        "        raise ValueError('x')\n"
        "    except (ValueError, ZeroDivisionError):\n"
        "        pass\n"
        "    pairs = sorted(zip(range(3), reversed([1, 2, 3])), key=lambda pair: pair[1])\n"
        "    total = sum(abs(a - b) for a, b in enumerate(map(float, info)))\n"
        "    return round(total + pairs[0][0] + next(iter(set([len(pairs)]))), 3)\n"
    )

    assert build(code).call(np.zeros(3)) == 8.0
