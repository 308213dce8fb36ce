"""Functions that hold something at their top level which a call could change.

The static check refuses the plain ways of changing it, but a value can have many names. So such a
function is defined anew for each call, and one that did change something is refused: no call can
remember another. This file runs in the worker.
"""

from collections.abc import Callable, Iterable, Mapping
from types import BuiltinFunctionType, FunctionType, ModuleType
from typing import Any

import numpy as np

from lqd_llm.sandbox.facades import is_facade

Function = Callable[[Any], Any]
Define = Callable[[], dict[str, Any]]
"""Runs the code of a function, and returns its globals."""

_PLAIN = (int, float, complex, str, type(None), type, range, np.generic, np.ufunc, type(np.mean))


class ChangedConstantError(Exception):
    """A function changed what it holds at its top level."""


class RenewedFunction:
    """A function that is defined anew for each call.

    Args:
        define: Runs its code.
        entry: Its name.
    """

    def __init__(self, define: Define, *, entry: str) -> None:
        self._define = define
        self._entry = entry
        self._form = _form_of_all(define())

    def __call__(self, argument: Any) -> Any:
        """Call it.

        Raises:
            ChangedConstantError: It changed what it holds.
        """
        namespace = self._define()
        value = namespace[self._entry](argument)
        try:
            same = _form_of_all(namespace) == self._form
        except RecursionError:
            # Something was put within itself.
            same = False
        if not same:
            raise ChangedConstantError
        return value


def can_be_changed(namespace: Mapping[str, Any]) -> bool:
    """Return whether code has left anything in its globals that might be changed later.

    Args:
        namespace: The globals.
    """
    return not _are_fixed(_own(namespace))


def _own(namespace: Mapping[str, Any]) -> list[Any]:
    # Code cannot bind the others: they are Python's, which notes there what it has warned of.
    return [value for name, value in namespace.items() if not name.startswith("__")]


def _are_fixed(values: Iterable[Any]) -> bool:
    return all(map(_is_fixed, values))


def _is_fixed(value: Any) -> bool:
    match value:
        case tuple() | frozenset():
            return _are_fixed(value)
        case FunctionType():
            named = (value.__kwdefaults__ or {}).values()
            return _are_fixed([*_cells(value), *named, *(value.__defaults__ or ())])
        case BuiltinFunctionType():
            # A method such as `[].append` is one too, and holds its list.
            return isinstance(value.__self__, ModuleType | None)
        case slice():
            return _are_fixed((value.start, value.stop, value.step))
        case _:
            return isinstance(value, _PLAIN) or is_facade(value)


def _form_of_all(namespace: Mapping[str, Any]) -> list[Any]:
    return [_form(value) for value in _own(namespace)]


def _form(value: Any) -> Any:
    """Return what is equal for a value and for the same one when the code runs again."""
    match value:
        case list() | tuple():
            parts: Any = tuple(map(_form, value))
        case dict():
            parts = tuple((_form(key), _form(entry)) for key, entry in value.items())
        case set() | frozenset():
            parts = frozenset(map(_form, value))
        case np.ndarray():
            entries = _form(value.tolist()) if value.dtype.hasobject else value.tobytes()
            parts = (value.shape, value.dtype.str, entries)
        case FunctionType():
            parts = tuple(map(_form, _cells(value)))
        case int() | str():
            parts = value
        case float() | complex() | np.generic():
            # Its text tells 0.0 from -0.0, and is the same for one NaN and another.
            parts = repr(value)
        case _:
            parts = None
    return (type(value), parts)


def _cells(function: FunctionType) -> list[Any]:
    return [cell.cell_contents for cell in function.__closure__ or ()]
