"""All calls of one motion, and their records. This file runs in the worker."""

import gc
import struct
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain
from typing import Any

from lqd_llm.sandbox.calls import (
    DROPPED,
    NO_MOMENT,
    Function,
    Infos,
    Record,
    call_descriptor,
    call_fitness,
    call_quantity,
    call_success,
    call_timestamp,
)
from lqd_llm.sandbox.reasons import Reason
from lqd_llm.sandbox.roles import Role
from lqd_llm.sandbox.wire import NO_FUNCTION, RECORD_FORMAT, Word, call_number, slots_of

_ACCEPTED = int(Reason.ACCEPTED)
_FIRST_NUMBER = 4


@dataclass(frozen=True)
class DefinedFunction:
    """A function that can be called, or one that no longer is.

    Attributes:
        role: Its role.
        call: The function; None: it was dropped.
    """

    role: Role
    call: Function | None


class MotionCalls:
    """Calls all functions on one motion after the other.

    Args:
        functions: The functions.
        words: The header of the results; it is told of each call before it begins.
    """

    def __init__(self, functions: Sequence[DefinedFunction], *, words: memoryview) -> None:
        roles = [function.role for function in functions]
        self._functions = [function.call for function in functions]
        self._words = words
        self._calls = 0
        self._slots = slots_of(roles)
        self._packer = struct.Struct("<" + RECORD_FORMAT * len(self._slots))
        self._on_infos: dict[Role, Callable[[Function, Infos], Record]] = {
            Role.SUCCESS: call_success,
            Role.FITNESS: call_fitness,
            Role.DESCRIPTOR: call_descriptor,
        }
        self._roles = roles

    @property
    def record_bytes(self) -> int:
        """Size of the records of one motion."""
        return self._packer.size

    def write(self, infos: Infos, *, into: Any, offset: int) -> None:
        """Call the functions on a motion and write its records.

        Args:
            infos: The motion's moments, read-only.
            into: The shared results.
            offset: Where the motion's records begin, in bytes.

        Raises:
            MemoryError: A function ran out of memory; the header still names it.
        """
        records = self._records(infos)
        self._packer.pack_into(into, offset, *chain.from_iterable(records))

    def begin(self, function: int) -> None:
        """Note in the header that a call begins.

        Args:
            function: Index of the function that is called, or `NO_FUNCTION`.
        """
        self._calls += 1
        self._words[Word.CALL] = call_number(self._calls, function)

    def _records(self, infos: Infos) -> list[Record]:
        places = {id(info): place for place, info in enumerate(infos)}
        picked: dict[int, int | None] = {}
        measured: dict[tuple[int, int], Record] = {}
        records: list[Record] = []
        for slot in self._slots:
            function, h = slot.function, slot.timestamp
            if h is None:
                record = self._on_motion(function, infos, places)
                if self._roles[function] is Role.TIMESTAMP:
                    accepted = record[0] == _ACCEPTED
                    picked[function] = int(record[_FIRST_NUMBER]) if accepted else None
            elif (place := picked[h]) is None:
                record = NO_MOMENT
            elif (place, function) in measured:
                record = measured[place, function]
            else:
                record = measured[place, function] = self._at_moment(function, infos[place])
            records.append(record)
        self.begin(NO_FUNCTION)
        return records

    def _on_motion(self, function: int, infos: Infos, places: Mapping[int, int]) -> Record:
        role = self._roles[function]
        if role is Role.TIMESTAMP:
            return self._ask(function, call_timestamp, infos, places)
        return self._ask(function, self._on_infos[role], infos)

    def _at_moment(self, function: int, moment: Mapping[str, Any]) -> Record:
        return self._ask(function, call_quantity, moment)

    def _ask(self, function: int, ask: Callable[..., Record], *arguments: Any) -> Record:
        call = self._functions[function]
        if call is None:
            return DROPPED
        self.begin(function)
        try:
            return ask(call, *arguments)
        except MemoryError:
            # Left at once: while it is handled, what the function holds is kept.
            pass
        # What others left behind may have taken the memory, and nobody should answer for that.
        gc.collect()
        self.begin(function)
        return ask(call, *arguments)
