"""One call of one function inside the worker, and the check of what it returned.

This file runs in the worker. It refuses what in-process evaluation refuses, for the same reasons;
a reason is sent as numbers, and the host puts it into words.
"""

import math
import sys
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from lqd_llm.sandbox.reasons import (
    EXCEPTION_NUMBERS,
    LONGEST,
    SHORTEST,
    TYPE_NUMBERS,
    Reason,
)
from lqd_llm.sandbox.renewal import ChangedConstantError

SOURCE_NAME = "<functional"
"""How the file names begin that the functions' code is compiled with."""

Record = tuple[int, int, int, int, float, float, float, float, float]
"""Reason, detail, line, length, and five numbers: `wire.RECORD` without its names."""

Infos = Sequence[Mapping[str, Any]]
Function = Callable[[Any], Any]

_ZEROS = (0.0,) * LONGEST
_ACCEPTED = int(Reason.ACCEPTED)
_LARGEST = sys.float_info.max

TRUE: Record = (_ACCEPTED, 0, 0, 1, 1.0, 0.0, 0.0, 0.0, 0.0)
FALSE: Record = (_ACCEPTED, 0, 0, 1, 0.0, 0.0, 0.0, 0.0, 0.0)


def plain(reason: Reason, *, detail: int = 0, line: int = 0, length: int = 0) -> Record:
    """Return the record of a reason without numbers."""
    return (int(reason), detail, line, length, 0.0, 0.0, 0.0, 0.0, 0.0)


NONE = plain(Reason.NONE)
NO_MOMENT = plain(Reason.NO_MOMENT)
DROPPED = plain(Reason.DROPPED)


class _RefusedError(Exception):
    def __init__(self, record: Record) -> None:
        super().__init__()
        self.record = record


def call_success(success: Function, infos: Infos) -> Record:
    """Ask a success function about a motion.

    Args:
        success: The function; it is given a list of its own.
        infos: The motion's moments.

    Raises:
        MemoryError: The function ran out of memory.
    """
    try:
        verdict = success(list(infos))
    except Exception as error:  # noqa: BLE001 (a model wrote this code, and it may raise anything)
        return raised(error)
    if not isinstance(verdict, bool | np.bool_):
        return plain(Reason.NOT_BOOL, detail=_type_of(verdict))
    return TRUE if verdict else FALSE


def call_fitness(fitness: Function, infos: Infos) -> Record:
    """Ask a fitness function about every moment of a motion, and take the exact mean.

    Args:
        fitness: The function.
        infos: The motion's moments, at least one.

    Raises:
        MemoryError: The function ran out of memory.
    """
    numbers = []
    finite = math.isfinite
    try:
        for info in infos:
            number = fitness(info)
            if type(number) is not float or not finite(number):
                number = _number(number)
            numbers.append(number)
    except _RefusedError as refused:
        return refused.record
    except Exception as error:  # noqa: BLE001
        return raised(error)
    try:
        mean = math.fsum(numbers) / len(numbers)
    except OverflowError:
        mean = math.inf
    if abs(mean) >= _LARGEST:
        return plain(Reason.MEAN_TOO_LARGE)
    return (_ACCEPTED, 0, 0, 1, mean, 0.0, 0.0, 0.0, 0.0)


def call_timestamp(timestamp: Function, infos: Infos, places: Mapping[int, int]) -> Record:
    """Ask a timestamp function which moment of a motion it picks.

    Args:
        timestamp: The function; it is given a list of its own.
        infos: The motion's moments.
        places: Index of each moment by its id.

    Returns:
        A record whose first number is the index of the moment.

    Raises:
        MemoryError: The function ran out of memory.
    """
    try:
        moment = timestamp(list(infos))
    except Exception as error:  # noqa: BLE001
        return raised(error)
    if moment is None:
        return NONE
    place = places.get(id(moment))
    if place is None:
        return plain(Reason.NOT_ELEMENT)
    return (_ACCEPTED, 0, 0, 1, float(place), 0.0, 0.0, 0.0, 0.0)


def call_quantity(quantity: Function, moment: Mapping[str, Any]) -> Record:
    """Ask a quantity function for its numbers at a moment.

    Args:
        quantity: The function.
        moment: The moment.

    Raises:
        MemoryError: The function ran out of memory.
    """
    try:
        return _numbers(quantity(moment))
    except _RefusedError as refused:
        return refused.record
    except Exception as error:  # noqa: BLE001
        return raised(error)


def call_descriptor(descriptor: Function, infos: Infos) -> Record:
    """Ask a descriptor function for its numbers.

    Args:
        descriptor: The function; it is given a list of its own.
        infos: The motion's moments.

    Raises:
        MemoryError: The function ran out of memory.
    """
    try:
        numbers = descriptor(list(infos))
        return NONE if numbers is None else _numbers(numbers)
    except _RefusedError as refused:
        return refused.record
    except Exception as error:  # noqa: BLE001
        return raised(error)


def raised(error: Exception) -> Record:
    """Return the record of an exception that left a function.

    Args:
        error: The exception, as it was caught by the caller of the function.

    Raises:
        MemoryError: It is one.
    """
    if isinstance(error, MemoryError):
        raise error
    if isinstance(error, ChangedConstantError):
        return plain(Reason.CHANGED)
    names = (kind.__name__ for kind in type(error).__mro__)
    number = next(EXCEPTION_NUMBERS[name] for name in names if name in EXCEPTION_NUMBERS)
    return plain(Reason.RAISED, detail=number, line=_line_of(error))


def _line_of(error: Exception) -> int:
    line, trace = 0, error.__traceback__
    while trace is not None:
        # The last line of the function's own source, not one of a library that it called.
        if trace.tb_frame.f_code.co_filename.startswith(SOURCE_NAME):
            line = trace.tb_lineno
        trace = trace.tb_next
    return line


def _numbers(numbers: Any) -> Record:
    if not isinstance(numbers, tuple | list):
        raise _RefusedError(plain(Reason.NOT_TUPLE, detail=_type_of(numbers)))
    length = len(numbers)
    if not SHORTEST <= length <= LONGEST:
        raise _RefusedError(plain(Reason.WRONG_COUNT, length=length))
    checked = [_number(number) for number in numbers]
    return (_ACCEPTED, 0, 0, length, *checked, *_ZEROS[length:])  # type: ignore[return-value]


def _number(value: Any) -> float:
    if not isinstance(value, int | float | np.bool_ | np.integer | np.floating):
        raise _RefusedError(plain(Reason.NOT_NUMBER, detail=_type_of(value)))
    try:
        number = float(value)
    except OverflowError:
        raise _RefusedError(plain(Reason.TOO_LARGE)) from None
    if not math.isfinite(number):
        raise _RefusedError(plain(Reason.NAN if math.isnan(number) else Reason.INFINITE))
    return number


def _type_of(value: Any) -> int:
    names = (kind.__name__ for kind in type(value).__mro__)
    return next(TYPE_NUMBERS[name] for name in names if name in TYPE_NUMBERS)
