"""Functionals of one's own tried on example moments, before a search rests on them."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np

from lqd_envs.perception import Info
from lqd_search.evaluation.functional_calls import RefusedValueError

_Function = TypeVar("_Function")
_Result = TypeVar("_Result")


@dataclass(frozen=True)
class Trial(Generic[_Result]):
    """What came of trying the functions of one kind.

    Attributes:
        results: For each function that can be used, in order, what it first gave.
        dropped: One sentence for each function that failed on all examples.
    """

    results: Mapping[str, _Result]
    dropped: tuple[str, ...]


def try_functions(
    kind: str,
    functions: Mapping[str, _Function],
    *,
    call: Callable[[_Function, Info], _Result],
    examples: Sequence[Info],
) -> Trial[_Result]:
    """Call each function, in this process, on the examples until it gives a result.

    Args:
        kind: Their kind, for the sentences.
        functions: The functions by name.
        call: Calls one of them on an example; it raises `RefusedValueError` where that fails.
        examples: Moments of the task, at least one.
    """
    results: dict[str, _Result] = {}
    dropped = []
    # As in a run: a value is judged by what it is, whatever NumPy would warn of.
    with np.errstate(all="ignore"):
        for name, function in functions.items():
            for example in examples:
                try:
                    results[name] = call(function, example)
                    break
                except RefusedValueError as refused:
                    reason = str(refused)
            else:
                dropped.append(
                    f"The {kind} function {name!r} is not used: on all of {len(examples)} example "
                    f"moments it failed, and on the last it {reason}."
                )
    return Trial(results, tuple(dropped))
