"""What the code of a function finds around it: pure builtins, and facades of `math` and `np`.

The static check keeps code from reading anything but the names listed in the allowlist. Here the
same names are all there is, so that a name which slipped through the check leads nowhere.
"""

import builtins
import math
from collections.abc import Callable, Mapping
from types import FunctionType, MappingProxyType
from typing import Any, NoReturn

import numpy as np

from lqd_llm.sandbox.allowlist import (
    BUILTINS,
    LINALG_NAMES,
    MATH_NAMES,
    NUMPY_CREATORS,
    NUMPY_NAMES,
    NUMPY_SHAPERS,
)

_NUMBERS = "biufc"
"""The kinds of elements that an array may have, as in `numpy.dtype.kind`."""


def new_namespace() -> dict[str, Any]:
    """Return fresh globals for the code of one function.

    Returns:
        `__builtins__`, with the builtins of the allowlist (an `isinstance` that takes an info for
        the dictionary that it stands for) and an `__import__` that does nothing, and the facades
        `math` and `np`. The dictionaries are new; the facades cannot be changed and are always the
        same.
    """
    allowed = {name: getattr(builtins, name) for name in BUILTINS}
    return {
        "__builtins__": {**allowed, "isinstance": _ISINSTANCE, "__import__": _IMPORT_NOTHING},
        "math": _MATH,
        "np": _NUMPY,
    }


def is_facade(value: object) -> bool:
    """Return whether a value is one of the facades."""
    return value is _MATH or value is _NUMPY or value is _NUMPY.linalg


def _facade(name: str, members: Mapping[str, Any]) -> Any:
    """Return an object that has the given attributes, and can neither gain nor lose any."""

    def refuse(*_: object) -> NoReturn:
        raise AttributeError(f"{name} cannot be changed")

    # Read from the class, which is faster than from an instance; a function would become a method.
    own = {
        member: staticmethod(value) if hasattr(type(value), "__get__") else value
        for member, value in members.items()
    }
    special = {
        "__slots__": (),
        "__setattr__": refuse,
        "__delattr__": refuse,
        "__repr__": lambda _: name,
    }
    return type("module", (), own | special)()


def _of_numbers(create: Callable[..., Any]) -> Callable[..., Any]:
    """Return a function that makes arrays as `create` does, but of numbers only.

    An array of texts can be read as times, and so tells the time of day; one of objects calls
    their methods.
    """
    numbers, several = _NUMBERS, (tuple, list)

    def creator(*args: Any, **kwargs: Any) -> Any:
        made: Any = create(*args, **kwargs)
        for array in made if made.__class__ in several else (made,):
            try:
                other = array.dtype.kind not in numbers
            except AttributeError:
                other = True
            if other:
                raise TypeError("an array can only hold numbers and truth values")
        return made

    return _alone(creator, name=create.__name__)


def _filled(pad: Callable[..., Any]) -> Callable[..., Any]:
    """Return `np.pad` without the mode that shows what was in memory before."""

    def filled(*args: Any, **kwargs: Any) -> Any:
        mode = args[2] if args[2:] else kwargs.get("mode")
        if mode == "empty":
            raise ValueError("the mode 'empty' leaves the new elements undefined")
        return pad(*args, **kwargs)

    return _alone(filled, name=pad.__name__)


def _isinstance_of_infos() -> Callable[..., Any]:
    """Return an `isinstance` for which the read-only view of a dictionary is a dictionary."""
    type_of, view, is_instance = type, MappingProxyType, isinstance

    def of_infos(value: Any, kind: Any, /) -> bool:
        return is_instance({} if type_of(value) is view else value, kind)

    return _alone(of_infos, name="isinstance")


def _import_nothing(*_: object) -> None:
    """Do nothing.

    When NumPy's C code first needs a module that is loaded already, it calls the `__import__` of
    the code that runs, and then takes the module from `sys.modules` whatever came of the call.
    """


def _alone(function: Any, *, name: str) -> Callable[..., Any]:
    """Return a function with globals of its own, through which there is nothing to be found."""
    errors = {kind.__name__: kind for kind in (AttributeError, TypeError, ValueError)}
    lonely = {"__builtins__": errors}
    return FunctionType(function.__code__, lonely, name, None, function.__closure__)


def _numpy_members() -> dict[str, Any]:
    members = {name: getattr(np, name) for name in NUMPY_NAMES}
    members["pad"] = _filled(members["pad"])
    members |= {name: _of_numbers(members[name]) for name in (*NUMPY_CREATORS, *NUMPY_SHAPERS)}
    # What was in memory before is nobody's business, and differs from call to call.
    members["empty"] = members["zeros"]
    members["linalg"] = _facade("np.linalg", {n: getattr(np.linalg, n) for n in LINALG_NAMES})
    return members


_ISINSTANCE = _isinstance_of_infos()
_IMPORT_NOTHING = _alone(_import_nothing, name="__import__")
_MATH = _facade("math", {name: getattr(math, name) for name in MATH_NAMES})
_NUMPY = _facade("np", _numpy_members())
