"""The namespace of a function: the same values as in plain Python, and nothing to reach from it."""

import __future__

import json
import math
import subprocess
import sys
import traceback
import types
from pathlib import Path
from types import MappingProxyType

import numpy as np
import pytest

from lqd_llm import load_recording
from lqd_llm.functions import ENTRIES
from lqd_llm.sandbox import check_source
from lqd_llm.sandbox.allowlist import (
    BUILTINS,
    FACADE_NAMES,
    NUMPY_CREATORS,
    NUMPY_SHAPERS,
    TYPE_PLACES,
)
from lqd_llm.sandbox.facades import new_namespace

CORPORA = Path(__file__).parent / "corpora"
BENIGN = [
    json.loads(line)
    for file in sorted(CORPORA.glob("benign*.jsonl"))
    for line in file.read_text("utf-8").splitlines()
]
FILE = "<functional>"


def in_sandbox(code, *, entry):
    checked = check_source(code, entry=entry)
    return defined(checked.source, entry=entry, namespace=new_namespace())


def in_python(code, *, entry):
    # Recorded functions have annotations such as `Info`, which is defined nowhere.
    flags = __future__.annotations.compiler_flag
    return defined(code, entry=entry, namespace={"math": math, "np": np}, flags=flags)


def defined(code, *, entry, namespace, flags=0):
    exec(compile(code, FILE, "exec", flags=flags), namespace)
    return namespace[entry]


def outcome(function, argument):
    """Return what a call returns, in a form that can be compared, or what it raises and where."""
    try:
        value = function(list(argument) if isinstance(argument, list) else argument)
    except Exception as error:  # noqa: BLE001 (whatever it is, both must raise it)
        frames = traceback.extract_tb(error.__traceback__)
        return type(error), str(error), [f.lineno for f in frames if f.filename == FILE]
    if isinstance(argument, list):
        places = [place for place, info in enumerate(argument) if info is value]
        value = ("element", *places) if places else value
    return type(value), repr(value)


def read_only(info):
    inner = {k: MappingProxyType(v) if isinstance(v, dict) else v for k, v in info.items()}
    return MappingProxyType(inner)


def motions(*infos, seed=3):
    """Return the given motions, and others that vary everything."""
    rng = np.random.default_rng(seed)
    return [*infos, *([varied(info, rng) for info in motion] for motion in infos)]


def varied(info, rng):
    def vary(value):
        if isinstance(value, bool):
            return bool(rng.random() < 0.5)
        if isinstance(value, dict):
            return {key: vary(inner) for key, inner in value.items()}
        return tuple(rng.normal(0.1, 0.3, 3).tolist()) if isinstance(value, tuple) else rng.random()

    return {key: vary(value) for key, value in info.items()}


def assert_same(code, *, entry, of_motion, motions):
    sandboxed, plain = in_sandbox(code, entry=entry), in_python(code, entry=entry)
    for infos in motions:
        for argument in [infos] if of_motion else infos:
            locked = [read_only(i) for i in infos] if of_motion else read_only(argument)
            assert outcome(sandboxed, locked) == outcome(plain, argument)


@pytest.mark.parametrize("case", [pytest.param(case, id=case["name"]) for case in BENIGN])
def test_benign_function_has_the_values_of_plain_python(case, contact, no_contact):
    assert_same(
        case["code"],
        entry=case["entry"],
        of_motion=case["kind"] in ("success", "timestamp"),
        motions=motions(contact, no_contact),
    )


def test_recorded_functions_have_the_values_of_plain_python(task, sample, contact, no_contact):
    recording = load_recording(task.name, sample=sample)
    for kind, exchange in recording.exchanges.items():
        for function in exchange.reply.functions:
            entry = ENTRIES.get(kind, function.name)
            assert_same(
                function.code,
                entry=entry,
                of_motion=entry not in ("fitness", "quantity"),
                motions=motions(contact, no_contact, seed=sample),
            )


@pytest.mark.parametrize(
    "code",
    [
        "def fitness(info):\n    a = [\n        1,\n        info['nothing'],\n    ]\n    return a",
        "from math import (\n  sqrt,\n  pi\n)\ndef fitness(\n    info: 'I',\n) -> (\n  int\n):\n"
        "    x: Dict[\n        str\n    ] = sqrt(\n        -1)",
        "def h(x):\n    raise ValueError(x)\n\ndef fitness(info):\n\n    return h(1)",
    ],
)
def test_errors_name_the_lines_of_the_code_as_written(code, no_contact):
    sandboxed = outcome(in_sandbox(code, entry="fitness"), no_contact[0])

    assert sandboxed == outcome(in_python(code, entry="fitness"), no_contact[0])
    assert sandboxed[2][0] > 2


def test_namespace_holds_builtins_and_facades_and_is_new_each_time():
    first, second = new_namespace(), new_namespace()

    assert set(first) == {"__builtins__", "math", "np"}
    assert tuple(first["__builtins__"]) == (*BUILTINS, "__import__")
    assert first == second
    assert first is not second
    assert first["__builtins__"] is not second["__builtins__"]


@pytest.mark.parametrize("path", FACADE_NAMES)
def test_facade_has_the_allowed_names_and_cannot_be_changed(path):
    facade = facade_of(path)
    name = FACADE_NAMES[path][0]

    assert [member for member in dir(facade) if "__" not in member] == sorted(FACADE_NAMES[path])
    for change in (setattr, lambda *a: delattr(*a[:2])):
        with pytest.raises(AttributeError, match=f"{path} cannot be changed"):
            change(facade, name, 1)
    with pytest.raises(AttributeError, match="cannot be changed"):
        facade.other = 1
    assert repr(facade) == path
    assert not hasattr(facade, "__dict__")


@pytest.mark.parametrize("path", FACADE_NAMES)
def test_facade_holds_no_module(path):
    facade, real = facade_of(path), {"math": math, "np": np, "np.linalg": np.linalg}[path]

    for name in FACADE_NAMES[path]:
        member = getattr(facade, name)
        assert not isinstance(member, types.ModuleType)
        if name not in (*NUMPY_CREATORS, *NUMPY_SHAPERS, "linalg"):
            assert member is getattr(real, name)


def facade_of(path):
    first, *rest = path.split(".")
    facade = new_namespace()[first]
    return getattr(facade, rest[0]) if rest else facade


ARGUMENTS = {
    "arange": (0, 3), "array": ([1, 2.5],), "asarray": ((True, False),), "empty": (2,),
    "eye": (2,), "full": ((2, 2), 1.5), "full_like": ([1.0], 2.0), "fromiter": ([1], float),
    "identity": (2,), "linspace": (0, 1, 3), "logspace": (0, 2, 3),
    "ones": (2,), "ones_like": ([1],), "zeros": (2,), "zeros_like": ([1.0],),
}  # fmt: skip
OBJECTS = {
    "arange": (0, 3, 1, object), "array": ([1, None],), "asarray": (["now"],), "empty": (2, "O"),
    "eye": (2, 2, 0, object), "full": (2, "now"), "full_like": ([1.0], 2.0, "O"),
    "fromiter": ([1], object), "identity": (2, object),
    "linspace": (0, 1, 3, True, True, "M8[s]"), "logspace": (0, 2, 3, True, 10, "O"),
    "ones": (2, "U3"),
    "ones_like": ([1], "O"), "zeros": (2, "M8[s]"), "zeros_like": ([1.0], "V8"),
}  # fmt: skip


@pytest.mark.parametrize("name", NUMPY_CREATORS)
def test_arrays_hold_numbers_and_nothing_else(name):
    create = getattr(facade_of("np"), name)
    expected = getattr(np, "zeros" if name == "empty" else name)(*ARGUMENTS[name])

    made = create(*ARGUMENTS[name])
    assert (made.dtype, made.tolist()) == (expected.dtype, expected.tolist())
    with pytest.raises(TypeError, match="an array can only hold numbers and truth values"):
        create(*OBJECTS[name])


def test_a_line_of_numbers_may_come_with_its_step():
    numbers, step = facade_of("np").linspace(0, 1, 5, retstep=True)

    assert numbers.tolist() == [0.0, 0.25, 0.5, 0.75, 1.0]
    assert step == 0.25


LONELY = {
    "__builtins__": {
        "AttributeError": AttributeError,
        "TypeError": TypeError,
        "ValueError": ValueError,
    }
}


@pytest.mark.parametrize("name", [*NUMPY_CREATORS, *NUMPY_SHAPERS])
def test_functions_of_ours_have_no_globals_of_use(name):
    assert getattr(facade_of("np"), name).__globals__ == LONELY


def test_isinstance_takes_infos_for_dictionaries_and_has_no_globals_of_use(no_contact):
    is_instance = new_namespace()["__builtins__"]["isinstance"]
    info = read_only(no_contact[0])

    assert is_instance.__globals__ == LONELY
    kinds = [dict, (int, dict), dict | int, list, object, float]
    assert [is_instance(info, kind) for kind in kinds] == [True, True, True, False, True, False]
    assert is_instance(1.5, (float, str))
    with pytest.raises(TypeError, match="arg 2 must be a type"):
        is_instance(info, 1)


SHAPED = {
    "append": ([1.0], [2.0]), "array_split": ([1.0, 2.0], 2), "broadcast_to": ([1.0], (2, 1)),
    "column_stack": ([[1.0], [2.0]],), "concatenate": ([[1.0], [2.0]],), "delete": ([1.0, 2.0], 0),
    "dstack": ([[1.0], [2.0]],), "expand_dims": ([1.0], 0), "fliplr": ([[1.0, 2.0]],),
    "hstack": ([[1.0], [2.0]],), "insert": ([1.0], 0, 2.0), "kron": ([1.0, 2.0], [3.0]),
    "meshgrid": ([1.0], [2.0, 3.0]), "moveaxis": ([[1.0, 2.0]], 0, 1),
    "pad": ([1.0], 2, "edge"), "repeat": ([1.0], 2), "reshape": ([1.0, 2.0], (2, 1)),
    "roll": ([1.0, 2.0], 1), "rot90": ([[1.0, 2.0]],), "select": ([np.array([True])], [[2.0]]),
    "split": ([1.0, 2.0], [1]), "stack": ([[1.0], [2.0]],), "swapaxes": ([[1.0, 2.0]], 0, 1),
    "take": ([1.0, 2.0], 1), "tile": ([1.0], 2), "vstack": ([[1.0], [2.0]],),
    "where": (np.array([True, False]), 1.0, 2.0),
}  # fmt: skip


@pytest.mark.parametrize("name", NUMPY_SHAPERS)
def test_other_shapes_are_those_of_numpy(name):
    arguments = SHAPED.get(name, ([1.0, 2.0],))

    assert repr(getattr(facade_of("np"), name)(*arguments)) == repr(getattr(np, name)(*arguments))


@pytest.mark.parametrize("strange", ["now", {"a": 1}], ids=["text", "object"])
# The others multiply, or choose between numbers, and take no texts and objects by themselves.
@pytest.mark.parametrize("name", [name for name in NUMPY_SHAPERS if name not in ("kron", "select")])
def test_other_shapes_hold_numbers_and_nothing_else(name, strange):
    arguments = _with(strange, SHAPED.get(name, ([1.0, 2.0],)))

    with pytest.raises(TypeError, match="an array can only hold numbers and truth values"):
        getattr(facade_of("np"), name)(*arguments)


def _with(strange, arguments):
    """Put something in the place of the numbers of an array."""
    if isinstance(arguments, float):
        return strange
    if isinstance(arguments, list | tuple):
        return type(arguments)(_with(strange, part) for part in arguments)
    return arguments


def test_several_arrays_are_looked_at_one_by_one():
    numpy = facade_of("np")

    assert [part.tolist() for part in numpy.atleast_1d(1, 2.5)] == [[1], [2.5]]
    assert numpy.where([False, True])[0].tolist() == [1]
    with pytest.raises(TypeError, match="an array can only hold numbers and truth values"):
        numpy.atleast_1d(1, "now")


@pytest.mark.parametrize("how", ["place", "name"])
def test_padding_shows_nothing_of_what_was_in_memory(how):
    given = (
        ((np.zeros(3), 4, "empty"), {}) if how == "place" else ((np.zeros(3), 4), {"mode": "empty"})
    )

    with pytest.raises(ValueError, match="leaves the new elements undefined"):
        facade_of("np").pad(*given[0], **given[1])


@pytest.mark.parametrize("name", sorted({*TYPE_PLACES, "sort", "unique", "diff", "add"}))
@pytest.mark.parametrize("given", [["now"], [3, 4], [["now", "now"], ["now", "now"]]])
def test_whatever_is_passed_for_a_type_no_array_of_times_comes_of_it(name, given):
    texts = np.sort(given)
    calls = [getattr(texts, name, None), getattr(facade_of("np"), name, None)]
    for call, before in zip(calls, [(), (texts,)], strict=True):
        for kind in ("M8", "M8[s]", "m8", "m8[s]", "datetime64"):
            for axes in ((), (0,), (0, 0), (0, 0, 1)):
                assert _kind_of(call, *before, *axes, kind) not in ("M", "V")


def _kind_of(call, *arguments):
    try:
        return call(*arguments).dtype.kind
    except (AttributeError, TypeError, ValueError, IndexError):
        return ""


def test_an_import_brings_nothing():
    namespace = new_namespace()
    exec("import os, numpy.linalg\nfrom_os = os", namespace)

    assert namespace["os"] is None
    assert namespace["numpy"] is None
    assert namespace["__builtins__"]["__import__"].__globals__ == LONELY


FIRST_CALLS = """
from lqd_llm.sandbox.allowlist import LINALG_NAMES, NUMPY_NAMES, VALUE_ATTRIBUTES
from lqd_llm.sandbox.facades import new_namespace

calls = [f"np.{name}({x})" for name in NUMPY_NAMES for x in ("a", "a, a", "a, 0")]
calls += [f"np.linalg.{name}({x})" for name in LINALG_NAMES for x in ("a", "a, a")]
calls += [f"a.{name}({x})" for name in sorted(VALUE_ATTRIBUTES) for x in ("", "0", "0, 1")]
namespace = new_namespace()
failed = []
for call in ["str(a)", "a / 0", *calls]:
    exec(f"def call(a):\\n    return {call}", namespace)
    try:
        namespace["call"](namespace["np"].array([[2.0, 1.0], [1.0, 3.0]]))
    except (KeyError, ImportError) as error:
        failed.append((call, repr(error)))
    except Exception:
        pass
print(failed)
"""


def test_nothing_that_numpy_imports_when_first_called_is_missing():
    # A new process, since NumPy remembers what it has found.
    done = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", FIRST_CALLS],
        capture_output=True,
        text=True,
        check=True,
    )

    assert done.stdout == "[]\n"


def test_other_builtins_are_not_there():
    namespace = new_namespace()
    exec("def fitness(info): return open('x')", namespace)

    with pytest.raises(NameError, match="name 'open' is not defined"):
        namespace["fitness"]({})
