"""Checking the records that a worker wrote: nothing in them is believed before."""

import sys
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lqd_llm.sandbox.allowlist import LONGEST_SOURCE
from lqd_llm.sandbox.errors import SandboxError
from lqd_llm.sandbox.reasons import LONGEST, SHORTEST, Reason, details
from lqd_llm.sandbox.roles import Role
from lqd_llm.sandbox.wire import MAGIC, VERSION, Status, Word

_NUMBER_REASONS = {Reason.NOT_NUMBER, Reason.TOO_LARGE, Reason.NAN, Reason.INFINITE}
_TUPLE_REASONS = _NUMBER_REASONS | {Reason.NOT_TUPLE, Reason.WRONG_COUNT}
_POSSIBLE = {
    Role.SUCCESS: {Reason.NOT_BOOL},
    Role.FITNESS: _NUMBER_REASONS | {Reason.MEAN_TOO_LARGE},
    Role.TIMESTAMP: {Reason.NONE, Reason.NOT_ELEMENT},
    Role.QUANTITY: _TUPLE_REASONS | {Reason.NO_MOMENT},
    Role.DESCRIPTOR: _TUPLE_REASONS | {Reason.NONE},
}
_ALWAYS_POSSIBLE = {Reason.ACCEPTED, Reason.RAISED}


def check_header(words: NDArray[np.uint64], *, start: int, motions: int) -> tuple[int, Status]:
    """Check the header of a worker.

    Args:
        words: A copy of its words.
        start: Motions that were complete before this worker was asked.
        motions: Motions in the chunk.

    Returns:
        How many motions are complete now, and what the worker says of itself.

    Raises:
        SandboxError: The header is not that of a worker of ours, or a number is out of range.
    """
    magic, version, done, status = (
        int(words[word]) for word in (Word.MAGIC, Word.VERSION, Word.DONE, Word.STATUS)
    )
    if (magic, version) != (MAGIC, VERSION):
        raise _garbage(f"a header with {magic:#x} and version {version}", "one of this version")
    if not start <= done <= motions:
        raise _garbage(f"{done} motions done", f"{start} to {motions}")
    if status not in set(Status):
        raise _garbage(f"status {status}", "one that there is")
    return done, Status(status)


def check_counts(words: NDArray[np.uint64], *, functions: int, slots: int) -> None:
    """Check that a worker counts as we do, once it has defined the functions.

    Args:
        words: A copy of its words.
        functions: Number of functions.
        slots: Number of values of a motion.

    Raises:
        SandboxError: It does not.
    """
    counted = (int(words[Word.FUNCTIONS]), int(words[Word.SLOTS]))
    if counted != (functions, slots):
        raise _garbage(f"{counted[0]} functions and {counted[1]} slots", f"{functions} and {slots}")


def check_definitions(records: NDArray[np.void], *, dropped: Sequence[bool]) -> None:
    """Check the records of the functions' definitions.

    Args:
        records: (functions,) `RECORD`, a copy.
        dropped: Which functions were dropped before.

    Raises:
        SandboxError: One is not of the right form.
    """
    there = ~np.array(dropped)
    possible = _ALWAYS_POSSIBLE | {Reason.NOT_DEFINED}
    _check_reasons(records[there], possible, what="a definition")
    _check_reasons(records[~there], {Reason.DROPPED}, what="a dropped definition")


def check_records(
    records: NDArray[np.void], *, roles: Sequence[Role], dropped: Sequence[bool], moments: int
) -> None:
    """Check the records of motions.

    Args:
        records: (motions, slots) `RECORD`, a copy.
        roles: The role of each slot's function.
        dropped: Whether each slot's function was dropped, by now.
        moments: Moments of each motion.

    Raises:
        SandboxError: One is not of the right form, or has a number that its role cannot give.
    """
    for slot, role in enumerate(roles):
        column = records[:, slot]
        possible = _POSSIBLE[role] | _ALWAYS_POSSIBLE | {Reason.CHANGED}
        if dropped[slot]:
            possible = possible | {Reason.DROPPED}
        _check_reasons(column, possible, what=f"a {role}")
        accepted = column[column["reason"] == Reason.ACCEPTED]
        numbers, lengths = accepted["numbers"], accepted["length"]
        if not np.isfinite(numbers).all():
            raise _garbage(f"a {role} of numbers that are not finite", "finite ones")
        tuples = role in (Role.QUANTITY, Role.DESCRIPTOR)
        fewest, most = (SHORTEST, LONGEST) if tuples else (1, 1)
        if not ((lengths >= fewest) & (lengths <= most)).all():
            raise _garbage(f"a {role} of another length", f"{fewest} to {most}")
        first = numbers[:, 0]
        if role is Role.FITNESS and not (np.abs(first) < sys.float_info.max).all():
            raise _garbage("a fitness as large as no mean may be", "a smaller one")
        if role is Role.SUCCESS and not np.isin(first, (0.0, 1.0)).all():
            raise _garbage("a success other than true and false", "one of these")
        if role is Role.TIMESTAMP and not np.isin(first, np.arange(moments)).all():
            raise _garbage("a moment that there is not", f"0 to {moments - 1}")


def _check_reasons(records: NDArray[Any], possible: set[Reason], *, what: str) -> None:
    for number in np.unique(records["reason"]).tolist():
        if number not in {int(reason) for reason in possible}:
            raise _garbage(f"the reason {number} for {what}", "one that there is")
        reason = Reason(number)
        of_it = records[records["reason"] == number]
        if (of_it["detail"] >= details(reason)).any():
            raise _garbage(f"a detail of {reason.name} out of range", f"below {details(reason)}")
        if (of_it["line"] > (LONGEST_SOURCE + 1 if reason is Reason.RAISED else 0)).any():
            raise _garbage(f"a line of {reason.name} out of range", "one of the code")
        lengths = of_it["length"]
        possible_count = (lengths >= 0) & ((lengths < SHORTEST) | (lengths > LONGEST))
        if reason is Reason.WRONG_COUNT and not possible_count.all():
            raise _garbage("a wrong count that is right or negative", "another")


def _garbage(got: str, expected: str) -> SandboxError:
    return SandboxError(
        f"Expected the sandbox's worker to write {expected}, but it wrote {got}; its results are "
        "not used. Look at the functions that ran in it."
    )
