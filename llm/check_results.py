"""What two runs of functions in the sandbox say about each of them."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from lqd_llm.check import CheckFailure, CheckOutcome
from lqd_llm.sandbox import (
    DroppedFunction,
    Results,
    Role,
    SandboxedFunction,
    check_source,
)

_PLACES = {"first": "0", "middle": "len(infos) // 2", "last": "-1"}

MOMENTS = tuple(
    SandboxedFunction(
        name,
        Role.TIMESTAMP,
        check_source(f"def timestamp(infos):\n    return infos[{place}]\n", entry="timestamp"),
    )
    for name, place in _PLACES.items()
)
"""Timestamps of our own, at which every quantity is called."""

_RAISED = re.compile(r"raised (?P<error>\w+)( in line (?P<line>\d+))?( (?P<when>while .*))?")
_ERRORS = {"timeout": "TimeoutError", "memory": "MemoryError", "crash": "Crash"}
_LENGTHS = (Role.QUANTITY, Role.DESCRIPTOR)


@dataclass(frozen=True, eq=False)
class CheckResults:
    """What functions gave for the example motions, called twice.

    Attributes:
        first: What they gave, in order.
        second: What they gave for the same motions from the last to the first.
        dropped: The functions that were dropped.
        motions: Number of the motions.
    """

    first: Results
    second: Results
    dropped: Sequence[DroppedFunction]
    motions: int

    def outcome(self, function: SandboxedFunction) -> CheckOutcome:
        """Return what came of the check of one of the functions."""
        values = _values(self.first, function)
        failure = (
            self._stopped(function)
            or self._refused(self.first, function)
            or self._refused(self.second, function)
            or self._other_length(function)
            or self._undefined(function)
            or _changed(values, _values(self.second, function)[::-1])
        )
        return CheckOutcome(
            failure, length=None if failure else self._length(function), values=values
        )

    def _stopped(self, function: SandboxedFunction) -> CheckFailure | None:
        for dropped in self.dropped:
            if (dropped.name, dropped.role) != (function.name, function.role):
                continue
            if dropped.cause in _ERRORS:
                reason = f"{dropped.reason} on one example motion"
                return CheckFailure(_ERRORS[dropped.cause], reason)
            return _failure(dropped.reason)
        return None

    def _refused(self, results: Results, function: SandboxedFunction) -> CheckFailure | None:
        for refused in results.refusals:
            if (refused.name, refused.role) == (function.name, function.role):
                motions = f"{len(refused.motions)} of {self.motions} example motions"
                return _failure(refused.reason, where=f"on {motions}")
        return None

    def _other_length(self, function: SandboxedFunction) -> CheckFailure | None:
        lengths = self._lengths(function)
        if len(lengths) < 2:
            return None
        told = " and ".join(map(str, lengths))
        return CheckFailure("ValueError", f"returned {told} numbers, not always as many")

    def _undefined(self, function: SandboxedFunction) -> CheckFailure | None:
        if function.role is not Role.DESCRIPTOR or self._lengths(function):
            return None
        return CheckFailure("ValueError", f"returned None on all {self.motions} example motions")

    def _length(self, function: SandboxedFunction) -> int | None:
        return self._lengths(function)[0] if function.role in _LENGTHS else None

    def _lengths(self, function: SandboxedFunction) -> list[int]:
        """Return how many numbers there were where there were any, each once."""
        results, name = self.first, function.name
        columns: list[NDArray[np.int64]] = []
        if function.role is Role.DESCRIPTOR:
            columns = [results.descriptor_lengths[name]]
        elif function.role is Role.QUANTITY:
            columns = [column for (_, g), column in results.lengths.items() if g == name]
        lengths = np.unique(np.concatenate([*columns, [0]]))
        return [int(length) for length in lengths if length]


def _values(results: Results, function: SandboxedFunction) -> NDArray[np.float64]:
    name = function.name
    match function.role:
        case Role.SUCCESS:
            return results.success[name][:, None].astype(np.float64)
        case Role.FITNESS:
            return results.fitness[name][:, None]
        case Role.TIMESTAMP:
            return results.moments[name][:, None].astype(np.float64)
        case Role.QUANTITY:
            # Not where other candidates look: these may look elsewhere the second time.
            return np.stack([results.quantities[own.name, name] for own in MOMENTS], axis=1)
        case Role.DESCRIPTOR:
            return results.descriptors[name]


def _changed(first: NDArray[np.float64], second: NDArray[np.float64]) -> CheckFailure | None:
    other = ~((first == second) | (np.isnan(first) & np.isnan(second)))
    if not other.any():
        return None
    motions = f"{int(np.any(other.reshape(len(other), -1), axis=1).sum())} of {len(other)}"
    return CheckFailure(
        "ValueError",
        f"gave another value when it was called a second time on {motions} example motions; it "
        "must depend on its argument alone and keep nothing between calls",
    )


def _failure(reason: str, *, where: str = "") -> CheckFailure:
    """Take apart what the sandbox says of a function."""
    if raised := _RAISED.fullmatch(reason):
        line = int(raised["line"]) if raised["line"] else None
        return CheckFailure(raised["error"], f"raised {raised['when'] or where}", line)
    error = "TypeError" if ", not a " in reason else "ValueError"
    return CheckFailure(error, f"{reason}, {where}" if where else reason)
