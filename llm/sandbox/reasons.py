"""Why a value is refused: the numbers that the worker sends, and their words."""

import builtins
from enum import IntEnum


class Reason(IntEnum):
    """What came of one call, as the worker tells it."""

    UNWRITTEN = 0
    ACCEPTED = 1
    NONE = 2
    """A timestamp or descriptor returned None, which it may."""
    NO_MOMENT = 3
    """A quantity was not called, since its timestamp gave no moment."""
    DROPPED = 4
    """The function was dropped before."""
    RAISED = 5
    NOT_BOOL = 6
    NOT_NUMBER = 7
    NOT_TUPLE = 8
    WRONG_COUNT = 9
    TOO_LARGE = 10
    NAN = 11
    INFINITE = 12
    MEAN_TOO_LARGE = 13
    NOT_ELEMENT = 14
    NOT_DEFINED = 15
    """Its code ran, and left no function."""
    CHANGED = 16
    """It changed what it holds at its top level, where it could remember a call."""


SHORTEST, LONGEST = 2, 5
"""How many numbers a quantity or a descriptor may return."""

EXCEPTIONS = (
    *sorted(
        name
        for name, value in vars(builtins).items()
        if isinstance(value, type) and issubclass(value, BaseException) and value.__name__ == name
    ),
    *("AxisError", "ComplexWarning", "DTypePromotionError", "LinAlgError", "TooHardError"),
    "UFuncTypeError",
)
"""Names of exceptions that the worker can send by number: Python's own, and NumPy's."""

TYPES = (
    *("object", "NoneType", "bool", "bytearray", "bytes", "complex", "dict", "dict_items"),
    *("dict_itemiterator", "dict_keyiterator", "dict_keys", "dict_valueiterator", "dict_values"),
    *("ellipsis", "enumerate", "filter", "float", "frozenset", "function", "generator", "int"),
    *("builtin_function_or_method", "callable_iterator", "coroutine", "list", "list_iterator"),
    *("list_reverseiterator", "longrange_iterator", "map", "memoryview", "method"),
    *("method_descriptor", "method-wrapper", "module", "NotImplementedType", "property", "range"),
    *("range_iterator", "reversed", "set", "set_iterator", "slice", "str", "str_iterator"),
    *("str_ascii_iterator", "tuple", "tuple_iterator", "type", "wrapper_descriptor", "zip"),
    *("ndarray", "ufunc", "_ArrayFunctionDispatcher", "flatiter", "nditer", "dtype"),
    *("float16", "float32", "float64", "longdouble", "int8", "int16", "int32", "int64"),
    *("uint8", "uint16", "uint32", "uint64", "longlong", "ulonglong"),
    *("complex64", "complex128", "clongdouble", "str_", "bytes_", "object_", "void"),
    *("datetime64", "timedelta64"),
    *(name for name in EXCEPTIONS),
)
"""Names of types that the worker can send by number; any other is sent as one it derives from."""

EXCEPTION_NUMBERS = {name: number for number, name in enumerate(EXCEPTIONS)}
TYPE_NUMBERS = {name: number for number, name in enumerate(TYPES)}
# A function sees the read-only view of a dictionary where Python would show it the dictionary.
TYPE_NUMBERS["mappingproxy"] = TYPE_NUMBERS["dict"]

# Which table the detail of a reason is a number of.
_BY_EXCEPTION = {Reason.RAISED}
_BY_TYPE = {Reason.NOT_BOOL, Reason.NOT_NUMBER, Reason.NOT_TUPLE}

_PLAIN = {
    Reason.TOO_LARGE: "returned an integer too large for a float",
    Reason.NAN: "returned NaN",
    Reason.INFINITE: "returned infinity",
    Reason.MEAN_TOO_LARGE: "returned numbers whose mean is too large for a float",
    Reason.NOT_ELEMENT: "returned something else than an element of infos or None",
    Reason.CHANGED: "changed a value at its top level, so that one call would remember another",
    Reason.NOT_DEFINED: "is not a function once its code has run",
}
_WANTED = {
    Reason.NOT_BOOL: "a bool",
    Reason.NOT_NUMBER: "a number",
    Reason.NOT_TUPLE: "a tuple of numbers",
}


def details(reason: Reason) -> int:
    """Return how many values the detail of a reason may have; 1: it is always 0."""
    if reason in _BY_EXCEPTION:
        return len(EXCEPTIONS)
    return len(TYPES) if reason in _BY_TYPE else 1


def words(reason: Reason, *, detail: int, line: int, length: int) -> str:
    """Put a refusal into words that complete "it ...".

    Args:
        reason: The reason; one of those for which a value is refused, `DROPPED` aside.
        detail: Number of the exception or type.
        line: Line of the code, for what was raised; 0: none is known.
        length: How many numbers were returned, for `WRONG_COUNT`.
    """
    if reason in _PLAIN:
        return _PLAIN[reason]
    if reason is Reason.RAISED:
        return f"raised {EXCEPTIONS[detail]}" + (f" in line {line}" if line else "")
    if reason is Reason.WRONG_COUNT:
        return f"returned {length} numbers, not between {SHORTEST} and {LONGEST}"
    name = TYPES[detail]
    value = "None" if name == "NoneType" else f"a value of type {name}"
    return f"returned {value}, not {_WANTED[reason]}"
