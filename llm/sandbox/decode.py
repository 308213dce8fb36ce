"""From checked records to results."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from lqd_llm.sandbox.functions import SandboxedFunction
from lqd_llm.sandbox.reasons import LONGEST, Reason, words
from lqd_llm.sandbox.results import NO_MOMENT, REFUSED, DroppedFunction, RefusedValues, Results
from lqd_llm.sandbox.roles import Role
from lqd_llm.sandbox.wire import Slot

_NOT_REFUSED = (Reason.ACCEPTED, Reason.NONE, Reason.NO_MOMENT)
_OTHER_LENGTH = 1000
"""A reason that only the host gives: not as many numbers as are expected."""

_Lengths = Mapping[tuple[Role, str], int]


def decode(
    records: NDArray[np.void],
    *,
    functions: Sequence[SandboxedFunction],
    slots: Sequence[Slot],
    lengths: _Lengths,
    dropped: Sequence[DroppedFunction],
    dropped_before: Mapping[tuple[Role, str], DroppedFunction],
) -> Results:
    """Turn the records of a batch into results.

    Args:
        records: (N, slots) `RECORD`, checked.
        functions: The functions.
        slots: The values of a motion, in order.
        lengths: For quantities and descriptors, by role and name, how many numbers are expected.
        dropped: The functions that were dropped during this batch.
        dropped_before: All functions that were dropped so far, by role and name.
    """
    reasons = records["reason"].astype(np.int64)
    for k, slot in enumerate(slots):
        function = functions[slot.function]
        expected = lengths.get((function.role, function.name))
        if expected is not None:
            other = (reasons[:, k] == Reason.ACCEPTED) & (records["length"][:, k] != expected)
            reasons[other, k] = _OTHER_LENGTH
    columns = _Columns(records, reasons, functions, slots)
    names = [function.name for function in functions]
    pairs = {
        (names[slot.timestamp], names[slot.function]): k
        for k, slot in enumerate(slots)
        if slot.timestamp is not None
    }
    return Results(
        success={name: columns.first(k) == 1.0 for name, k in columns.of(Role.SUCCESS)},
        fitness={name: columns.first(k) for name, k in columns.of(Role.FITNESS)},
        moments={name: columns.moments(k) for name, k in columns.of(Role.TIMESTAMP)},
        quantities={pair: columns.numbers(k) for pair, k in pairs.items()},
        lengths={pair: columns.lengths(k) for pair, k in pairs.items()},
        descriptors={name: columns.numbers(k) for name, k in columns.of(Role.DESCRIPTOR)},
        descriptor_lengths={name: columns.lengths(k) for name, k in columns.of(Role.DESCRIPTOR)},
        refusals=columns.refusals(lengths=lengths, dropped=dropped_before),
        dropped=tuple(dropped),
    )


class _Columns:
    def __init__(
        self,
        records: NDArray[np.void],
        reasons: NDArray[np.int64],
        functions: Sequence[SandboxedFunction],
        slots: Sequence[Slot],
    ) -> None:
        self._records = records
        self._reasons = reasons
        self._of_slot = [functions[slot.function] for slot in slots]
        self._accepted = reasons == Reason.ACCEPTED

    def of(self, role: Role) -> list[tuple[str, int]]:
        return [(own.name, k) for k, own in enumerate(self._of_slot) if own.role is role]

    def first(self, slot: int) -> NDArray[np.float64]:
        first = self._records["numbers"][:, slot, 0]
        return np.where(self._accepted[:, slot], first, np.nan)

    def moments(self, slot: int) -> NDArray[np.int64]:
        absent = np.where(self._reasons[:, slot] == Reason.NONE, NO_MOMENT, REFUSED)
        first = np.where(self._accepted[:, slot], self._records["numbers"][:, slot, 0], 0.0)
        return np.where(self._accepted[:, slot], first.astype(np.int64), absent)

    def lengths(self, slot: int) -> NDArray[np.int64]:
        return np.where(self._accepted[:, slot], self._records["length"][:, slot], 0)

    def numbers(self, slot: int) -> NDArray[np.float64]:
        there = np.arange(LONGEST) < self.lengths(slot)[:, None]
        return np.where(there, self._records["numbers"][:, slot], np.nan)

    def refusals(
        self, *, lengths: _Lengths, dropped: Mapping[tuple[Role, str], DroppedFunction]
    ) -> tuple[RefusedValues, ...]:
        motions: dict[tuple[Role, str, str], list[NDArray[np.intp]]] = {}
        first: dict[tuple[Role, str, str], tuple[int, int]] = {}
        for k, function in enumerate(self._of_slot):
            for number, reason in self._kinds(k, function, lengths=lengths, dropped=dropped):
                key = (function.role, function.name, reason)
                motions.setdefault(key, []).append(number)
                met = (int(number[0]), k)
                first[key] = min(first.get(key, met), met)
        return tuple(
            RefusedValues(name, role, reason, np.unique(np.concatenate(parts)))
            for (role, name, reason), parts in sorted(
                motions.items(), key=lambda item: first[item[0]]
            )
        )

    def _kinds(
        self,
        slot: int,
        function: SandboxedFunction,
        *,
        lengths: _Lengths,
        dropped: Mapping[tuple[Role, str], DroppedFunction],
    ) -> list[tuple[NDArray[np.intp], str]]:
        """Return the motions that were refused, ascending, for each reason."""
        rows = np.flatnonzero(~np.isin(self._reasons[:, slot], _NOT_REFUSED))
        records = self._records[rows, slot]
        told = np.stack(
            [
                self._reasons[rows, slot],
                records["detail"].astype(np.int64),
                records["line"].astype(np.int64),
                records["length"],
            ],
            axis=1,
        )
        kinds, number = np.unique(told, axis=0, return_inverse=True)
        refused = []
        for k, (reason, detail, line, length) in enumerate(kinds.tolist()):
            key = (function.role, function.name)
            if reason == _OTHER_LENGTH:
                text = f"returned {length} numbers, not {lengths[key]} as on an example"
            elif reason == Reason.DROPPED:
                text = dropped[key].reason
            else:
                text = words(Reason(reason), detail=detail, line=line, length=length)
            refused.append((rows[number.reshape(-1) == k], text))
        return refused
