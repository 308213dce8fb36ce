"""A run's state as a pickle that can name nothing but what a state is made of."""

import io
import pickle
import struct
from collections.abc import Callable, Iterable
from enum import Enum
from importlib import import_module
from types import FunctionType, MethodType
from typing import Any, TypeAlias

import numpy as np

from lqd_envs import LQDError
from lqd_search.runs.numpy_state import NumPyStateError, reduce_numpy

Trusted: TypeAlias = type | Callable[..., Any]
"""A class, or a function of a module, that a state may name."""

MODULES = (
    "lqd_envs.solution_space",
    "lqd_envs.verdict",
    "lqd_search.archives",
    "lqd_search.emitters",
    "lqd_search.evaluation.descriptor_report",
    "lqd_search.evaluation.values",
    "lqd_search.methods",
    "lqd_search.runs.metrics",
    "lqd_search.runs.run_config",
    "lqd_search.runs.run_state",
    "lqd_search.runs.tally",
    "lqd_search.schedulers",
    "lqd_search.solution_space",
    "ribs.archives._archive_stats",
    "ribs.archives._array_store",
    "ribs.archives._grid_archive",
    "ribs.emitters._evolution_strategy_emitter",
    "ribs.emitters._gaussian_emitter",
    "ribs.emitters._iso_line_emitter",
    "ribs.emitters.opt._cma_es",
    "ribs.emitters.opt._sep_cma_es",
    "ribs.emitters.rankers",
)
"""Modules, and packages with all that is in them, whose classes a state may hold instances of.

A class of these must do no harm whatever it is made with: it opens no file and runs no text.
"""

NAMES = frozenset(
    {
        "builtins.bool",
        "builtins.complex",
        "builtins.float",
        "builtins.int",
        "builtins.range",
        "builtins.slice",
        "builtins.str",
        "collections.Counter",
        "collections.OrderedDict",
        "collections.deque",
        "lqd_search.archives.competition.compete_by_fitness",
        "lqd_search.archives.success_grid._restored",
        "lqd_search.emitters.screen.carried_out",
        "lqd_search.evaluation.contact.touched",
        "lqd_search.methods.by_name.repair_motions",
        "lqd_search.runs.numpy_state.array_of",
        "lqd_search.runs.numpy_state.bit_generator_of",
        "lqd_search.runs.numpy_state.dtype_of",
        "lqd_search.runs.numpy_state.generator_of",
        "lqd_search.runs.numpy_state.scalar_of",
        "lqd_search.runs.numpy_state.seed_sequence_of",
    }
)
"""Further classes, and functions, that a state may name, as harmless as those classes."""

_NUMBERS = {
    f"numpy.{kind.__name__}": kind
    for kind in set(np.sctypeDict.values())
    if issubclass(kind, np.number | np.bool_)
}
# A class of pyribs imports the module that its state names here.
_NAMESPACES = ("array_api_compat.numpy", "numpy")
# What a pickle of protocol 5 is written in, less what no state needs.
_OPCODES = (  # noqa: SIM905
    "PROTO FRAME STOP MEMOIZE BINGET LONG_BINGET MARK POP POP_MARK NONE NEWTRUE NEWFALSE BININT "
    "BININT1 BININT2 LONG1 LONG4 BINFLOAT SHORT_BINUNICODE BINUNICODE BINUNICODE8 SHORT_BINBYTES "
    "BINBYTES BINBYTES8 EMPTY_TUPLE TUPLE1 TUPLE2 TUPLE3 TUPLE EMPTY_LIST APPEND APPENDS "
    "EMPTY_DICT SETITEM SETITEMS EMPTY_SET ADDITEMS FROZENSET STACK_GLOBAL REDUCE NEWOBJ BUILD"
).split()
# The one in Python, since that in C can neither be told what it may call nor what it may change.
_PythonUnpickler: Any = pickle._Unpickler
_DAMAGE = (
    pickle.PickleError,
    ArithmeticError,
    AttributeError,
    EOFError,
    ImportError,
    LookupError,
    MemoryError,
    RecursionError,
    TypeError,
    ValueError,
    LQDError,
    struct.error,
)


class StateError(LQDError):
    """A state that cannot be pickled, or a pickle of none; the text says why, in half a line."""


class UntrustedNameError(StateError):
    """A pickle that names what is neither known nor trusted."""


def pickle_state(state: Any, *, trusted: Iterable[Trusted] = ()) -> bytes:
    """Return the pickle of a state.

    Args:
        state: Made of plain Python values, NumPy's arrays, scalars and generators, and instances
            of the classes in `MODULES`.
        trusted: Further classes and functions that it may name.

    Raises:
        StateError: It holds something else.
    """
    body = io.BytesIO()
    try:
        _StatePickler(body, trusted).dump(state)
    except NumPyStateError as error:
        raise StateError(str(error)) from error
    except (pickle.PicklingError, AttributeError, TypeError, RecursionError) as error:
        raise StateError(f"it cannot be pickled: {_in_one_line(error)}") from error
    return body.getvalue()


def unpickle_state(content: bytes | memoryview, *, trusted: Iterable[Trusted] = ()) -> Any:
    """Return the state that a pickle holds, from whomever it came.

    A pickle says which functions are called to rebuild what it holds. Here it can name only
    `NAMES`, NumPy's number types and the classes of `MODULES`; it can call only these,
    and change only what it made itself. So it cannot run text or programs, open files or import
    other modules. It is no protection against a file that fills the memory, that makes a wrong
    state on purpose, or that finds a fault in one of these classes or in Python itself.

    Args:
        content: What `pickle_state` returned.
        trusted: As it was given there.

    Raises:
        UntrustedNameError: It names something else.
        StateError: It cannot be read.
    """
    try:
        return _StateUnpickler(io.BytesIO(content), trusted).load()
    except StateError:
        raise
    # Whatever a class that has changed since, or a pickle made to do harm, may run into.
    except _DAMAGE as error:
        raise StateError(f"{type(error).__name__}: {_in_one_line(error)}") from error


class _StatePickler(pickle.Pickler):
    def __init__(self, file: io.BytesIO, trusted: Iterable[Trusted]) -> None:
        super().__init__(file, protocol=5)
        self._trusted = {_name_of(named): named for named in trusted}

    def reducer_override(self, obj: Any) -> Any:
        reduced = reduce_numpy(obj)
        if reduced is not None:
            return reduced
        # The first releases of Python 3.11 would name `getattr` for a member.
        if isinstance(obj, Enum):
            return type(obj), (obj.value,)
        # Python would name `getattr`, which could reach anything.
        if isinstance(obj, MethodType):
            raise StateError(f"it holds the bound method {obj.__qualname__}; hold the instance")
        named = obj if isinstance(obj, type | FunctionType) else type(obj)
        # Here and not only when it is read, which may be after days of computing.
        if self._trusted.get(_name_of(named)) is not named and not _is_known(named):
            raise StateError(f"it holds {_name_of(named)}, which no state may name")
        return NotImplemented


class _StateUnpickler(_PythonUnpickler):  # type: ignore[misc]
    dispatch = {  # noqa: RUF012
        code: load
        for code, load in _PythonUnpickler.dispatch.items()
        if code in {vars(pickle)[name][0] for name in _OPCODES}
    }

    def __init__(self, file: io.BytesIO, trusted: Iterable[Trusted]) -> None:
        super().__init__(file)
        self._trusted = {_name_of(named): named for named in trusted}

    def find_class(self, module: str, name: str) -> Any:
        full = f"{module}.{name}"
        if full in self._trusted or full in _NUMBERS:
            return self._trusted.get(full) or _NUMBERS[full]
        # Modules hold others that they imported, and classes hold functions: neither is named.
        if full in NAMES or (_is_inside(module) and "." not in name):
            found: Any = getattr(import_module(module), name, None)
            is_named_so = isinstance(found, type | FunctionType) and _name_of(found) == full
            if is_named_so and _is_known(found):
                return found
        raise UntrustedNameError(f"it names {full}, which no state may name")

    def load_reduce(self) -> None:
        function = self.stack[-2]
        if not isinstance(function, type | FunctionType):
            raise StateError(f"it calls an instance of {_name_of(type(function))}")
        super().load_reduce()

    def load_newobj(self) -> None:
        if not isinstance(self.stack[-2], type):
            raise StateError(f"it makes an instance of {_name_of(type(self.stack[-2]))}")
        super().load_newobj()

    def load_build(self) -> None:
        instance, state = self.stack[-2:]
        kind = type(instance)
        known = self._trusted.get(_name_of(kind)) is kind or _is_known(kind)
        # There is one of each member of an enumeration, so a change would outlast the state.
        if not known or isinstance(instance, Enum):
            raise StateError(f"it changes {_name_of(kind)}")
        if hasattr(kind, "XP_NAME") and not _is_on_numpy(state):
            raise StateError(f"it holds {_name_of(kind)} without NumPy")
        super().load_build()

    dispatch[pickle.REDUCE[0]] = load_reduce
    dispatch[pickle.NEWOBJ[0]] = load_newobj
    dispatch[pickle.BUILD[0]] = load_build


def _is_known(named: Trusted) -> bool:
    full = _name_of(named)
    return (
        full in NAMES
        or _NUMBERS.get(full) is named
        or (isinstance(named, type) and _is_inside(named.__module__))
    )


def _is_inside(module: str) -> bool:
    return module.startswith(tuple(f"{name}." for name in MODULES)) or module in MODULES


def _is_on_numpy(state: Any) -> bool:
    return (
        type(state) is dict
        and "XP_NAME" not in state
        and state.get("_xp", _NAMESPACES[0]) in _NAMESPACES
    )


def _name_of(named: Trusted) -> str:
    return f"{named.__module__}.{named.__qualname__}"


def _in_one_line(error: BaseException) -> str:
    return " ".join(str(error).split())
