"""One call of one functional in this process, and the check of what it returned.

A functional that a model wrote is called by `lqd_llm.sandbox` instead, which checks the same.
"""

import math
from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np

from lqd_envs.errors import LQDError
from lqd_envs.perception import (
    DescriptorFunction,
    FitnessFunction,
    Info,
    Infos,
    QuantityFunction,
    SuccessFunction,
    TimestampFunction,
)

_Argument = TypeVar("_Argument")
_Result = TypeVar("_Result")
_SHORTEST, _LONGEST = 2, 5


class RefusedValueError(LQDError):
    """A functional raised, or returned what it was not asked for; the text completes "it ..."."""


def call_success(success: SuccessFunction, infos: Infos) -> bool:
    """Ask a success function about a motion.

    Args:
        success: The function; it is given a list of its own.
        infos: The motion's moments.

    Returns:
        Its verdict.

    Raises:
        RefusedValueError: It raised or did not return a bool (Python's or NumPy's).
    """
    verdict: Any = _call(success, list(infos))
    if not isinstance(verdict, bool | np.bool_):
        raise RefusedValueError(f"returned {_kind_of(verdict)}, not a bool")
    return bool(verdict)


def call_fitness(fitness: FitnessFunction, infos: Infos) -> float:
    """Ask a fitness function about every moment of a motion, and take the mean.

    Args:
        fitness: The function.
        infos: The motion's moments, at least one.

    Returns:
        The mean, exactly rounded.

    Raises:
        RefusedValueError: It raised or did not return a finite number at some moment, or the mean
            is too large.
    """
    numbers = [_number(_call(fitness, info)) for info in infos]
    try:
        mean = math.fsum(numbers) / len(numbers)
    except OverflowError:
        mean = math.inf
    # An archive needs an objective strictly above the lowest float.
    if abs(mean) >= float(np.finfo(np.float64).max):
        raise RefusedValueError("returned numbers whose mean is too large for a float")
    return mean


def call_timestamp(timestamp: TimestampFunction, infos: Infos) -> Info | None:
    """Ask a timestamp function which moment of a motion it picks.

    Args:
        timestamp: The function; it is given a list of its own.
        infos: The motion's moments.

    Returns:
        One of the elements of `infos`, itself and not a copy; None: that moment never came.

    Raises:
        RefusedValueError: It raised or returned anything else.
    """
    moment = _call(timestamp, list(infos))
    if moment is not None and not any(moment is info for info in infos):
        raise RefusedValueError("returned something else than an element of infos or None")
    return moment


def call_quantity(quantity: QuantityFunction, moment: Info) -> tuple[float, ...]:
    """Ask a quantity function for its numbers at a moment.

    Args:
        quantity: The function.
        moment: The moment.

    Returns:
        2 to 5 finite numbers.

    Raises:
        RefusedValueError: It raised or did not return a tuple or list of 2 to 5 finite numbers.
    """
    return _numbers(_call(quantity, moment))


def call_descriptor(descriptor: DescriptorFunction, infos: Infos) -> tuple[float, ...] | None:
    """Ask a descriptor function, which is given a whole motion, for its numbers.

    Args:
        descriptor: The function; it is given a list of its own.
        infos: The motion's moments.

    Returns:
        2 to 5 finite numbers; None: not defined for this motion.

    Raises:
        RefusedValueError: It raised or returned anything else.
    """
    numbers = _call(descriptor, list(infos))
    return None if numbers is None else _numbers(numbers)


def _call(function: Callable[[_Argument], _Result], argument: _Argument) -> _Result:
    try:
        return function(argument)
    except Exception as error:
        # Somebody else wrote this code, and it may raise anything.
        raise RefusedValueError(f"raised {type(error).__name__}{_line_of(error)}") from error


def _line_of(error: Exception) -> str:
    trace = error.__traceback__.tb_next if error.__traceback__ else None
    if trace is None:
        return ""
    # The last line of the function's own source, not one of a library that it called.
    file, line = trace.tb_frame.f_code.co_filename, trace.tb_lineno
    while trace := trace.tb_next:
        if trace.tb_frame.f_code.co_filename == file:
            line = trace.tb_lineno
    return f" in line {line}"


def _numbers(numbers: Any) -> tuple[float, ...]:
    if not isinstance(numbers, tuple | list):
        raise RefusedValueError(f"returned {_kind_of(numbers)}, not a tuple of numbers")
    if not _SHORTEST <= len(numbers) <= _LONGEST:
        raise RefusedValueError(
            f"returned {len(numbers)} numbers, not between {_SHORTEST} and {_LONGEST}"
        )
    return tuple(_number(number) for number in numbers)


def _number(value: Any) -> float:
    if not isinstance(value, int | float | np.bool_ | np.integer | np.floating):
        raise RefusedValueError(f"returned {_kind_of(value)}, not a number")
    try:
        number = float(value)
    except OverflowError:
        raise RefusedValueError("returned an integer too large for a float") from None
    if not math.isfinite(number):
        raise RefusedValueError(f"returned {'NaN' if math.isnan(number) else 'infinity'}")
    return number


def _kind_of(value: Any) -> str:
    return "None" if value is None else f"a value of type {type(value).__name__}"
