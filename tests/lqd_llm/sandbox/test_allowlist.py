"""What the lists of the allowlist let code get hold of."""

import ast
import types

import numpy as np
import pytest

from lqd_llm.sandbox.allowlist import (
    BUILTINS,
    FACADE_NAMES,
    MUTATORS,
    NODES,
    NUMPY_CREATORS,
    NUMPY_NAMES,
    NUMPY_TYPES,
    VALUE_ATTRIBUTES,
)
from lqd_llm.sandbox.facades import new_namespace

LISTS = {
    "BUILTINS": BUILTINS,
    "VALUE_ATTRIBUTES": VALUE_ATTRIBUTES,
    **{f"FACADE_NAMES[{facade!r}]": names for facade, names in FACADE_NAMES.items()},
}
NUMBERS = (bool, int, float, complex, np.number, np.bool_)
PLAIN = (*NUMBERS, str, tuple, list, dict, np.ndarray, type(None))
METHODS = (
    *(types.BuiltinMethodType, types.MethodWrapperType, types.MethodDescriptorType),
    *(types.ClassMethodDescriptorType, types.GetSetDescriptorType, types.MemberDescriptorType),
)


def a_generator():
    yield 1


def caught(error):
    try:
        raise error
    except type(error) as raised:
        return raised


def values():
    namespace = new_namespace()
    functions = [getattr(namespace["np"], name) for name in sorted(NUMPY_NAMES) if name != "linalg"]
    plain = [True, 1, 1.5, 1j, "a", (1,), [1], {"a": 1}, {1}, frozenset({1}), range(3), None, ...]
    arrays = [np.zeros(2), np.zeros((2, 2), bool), np.float64(1), np.bool_(True), np.int64(1)]
    iterators = [
        iter([1]),
        iter({}),
        zip(),
        map(abs, []),
        enumerate([]),
        reversed([]),
        a_generator(),
    ]
    views = [{}.keys(), {}.values(), {}.items(), types.MappingProxyType({"a": 1}), slice(1)]
    errors = [caught(error) for error in (KeyError("a"), ZeroDivisionError(), StopIteration(1))]
    errors += [caught(np.linalg.LinAlgError("a"))]
    builtins = [value for _, value in sorted(namespace["__builtins__"].items())]
    others = [lambda: 0, a_generator, "a".join, np.zeros(1).sum, *functions]
    return plain + arrays + iterators + views + errors + builtins + others


@pytest.mark.parametrize("value", values(), ids=lambda value: type(value).__name__)
def test_attributes_lead_to_nothing_but_data_and_methods(value):
    allowed = VALUE_ATTRIBUTES.union(*FACADE_NAMES.values())
    for name in sorted(allowed.intersection(dir(value))):
        assert isinstance(getattr(value, name), PLAIN + METHODS), name


@pytest.mark.parametrize("names", LISTS.values(), ids=LISTS)
def test_no_name_is_private_or_dangerous(names):
    dangerous = {
        *("args", "at", "base", "buffer", "build", "byteswap", "bytes", "bytearray", "choose"),
        *("close", "compile", "copyto", "cr_frame", "ctypes", "ctypeslib", "data", "datetime64"),
        *("delattr", "device", "dir", "dtype", "dump", "dumps", "emath", "encode", "errstate"),
        *("eval", "exec", "exit", "f2py", "f_globals", "fft", "flags", "flat", "format"),
        *("format_map", "frombuffer", "fromfile", "fromfunction", "fromhex", "from_bytes"),
        *("frompyfunc", "fromregex", "fromstring", "genfromtxt", "getattr", "getfield", "gi_frame"),
        *("globals", "hasattr", "hash", "help", "id", "input", "item_size", "itemset", "lib"),
        *("ljust", "load", "loadtxt", "locals", "maketrans", "memmap", "memoryview", "mro"),
        *("ndarray", "newbyteorder", "object", "obj", "open", "partial", "print", "put", "putmask"),
        *("random", "rec", "rjust", "save", "savetxt", "savez", "seterr", "seterrcall", "setattr"),
        *("setfield", "setflags", "strides", "super", "sys", "tb_frame", "test", "testing"),
        *("throw", "to_bytes", "tobytes", "tofile", "translate", "type", "value", "vars"),
        *("vectorize", "view", "void", "with_traceback", "zfill"),
    }

    assert not dangerous.intersection(names)
    assert not [name for name in names if name.startswith("_")]
    assert len(set(names)) == len(names)


def test_lists_within_lists():
    assert MUTATORS <= VALUE_ATTRIBUTES
    assert {*NUMPY_CREATORS, *NUMPY_TYPES} <= set(NUMPY_NAMES)
    assert set(FACADE_NAMES) == {"math", "np", "np.linalg"}


def test_nodes_are_kinds_of_syntax():
    assert all(issubclass(node, ast.AST) for node in NODES)
    assert not NODES & {ast.Import, ast.ImportFrom, ast.ClassDef, ast.Del, ast.Delete, ast.With}
