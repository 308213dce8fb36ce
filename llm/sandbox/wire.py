"""What passes between the host and the worker: fixed-size arrays and fixed-size messages.

The host writes columns, which the worker can only read. The worker writes one record for each value
of a motion, and a header of whole numbers; the host reads both, and believes neither before it has
checked them. Nothing that a worker wrote is unpickled, parsed or evaluated.
"""

import struct
from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum, IntFlag
from typing import Any

import numpy as np

from lqd_llm.sandbox.info_layout import InfoLayout
from lqd_llm.sandbox.roles import Role

MAGIC = int.from_bytes(b"lqd sand", "little")
VERSION = 1

CAPACITY = 512
"""Motions that the shared arrays hold; more are passed one chunk after another."""

RECORD = np.dtype(
    [
        ("reason", "<u2"),
        ("detail", "<u2"),
        ("line", "<u4"),
        ("length", "<i8"),
        ("numbers", "<f8", (5,)),
    ]
)
"""One value: a `Reason`, what it is about, and up to five numbers."""

RECORD_FORMAT = "HHIq5d"
"""The same for `struct`."""


class Word(IntEnum):
    """The header's whole numbers, 8 bytes each, by place."""

    MAGIC = 0
    VERSION = 1
    FUNCTIONS = 2
    SLOTS = 3
    LOCKS = 4
    """Which locks are on, a `Lock` set."""
    STATUS = 5
    DONE = 6
    """Motions of this chunk whose records are complete."""
    CALL = 7
    """`call_number`: which call is running, and of which function."""


class Status(IntEnum):
    """What a worker says of itself."""

    STARTING = 0
    WORKING = 1
    OUT_OF_MEMORY = 2
    """The function that was running ran out of memory, and the worker ended."""


class Lock(IntFlag):
    """The locks that a worker puts on itself."""

    RLIMITS = 1
    CAPABILITIES = 2
    LANDLOCK = 4
    SECCOMP = 8


class Command(IntEnum):
    """What the host asks for; each is answered with its own number, in one byte."""

    READY = 1
    """Not asked for: the worker says it once its locks are on."""
    DEFINE = 2
    """Followed by the length of a JSON text, and that text: the layout and the functions."""
    RUN = 3
    """Followed by the numbers of motions and moments, and the motion to begin with."""


@dataclass(frozen=True)
class Order:
    """What a worker is told on its command line.

    Attributes:
        parent: Process that it must not outlive.
        columns: File descriptor of the shared columns, and their size in bytes.
        results: The same of the shared results.
        memory_bytes: As of `Limits`.
    """

    parent: int
    columns: tuple[int, int]
    results: tuple[int, int]
    memory_bytes: int


COMMAND = struct.Struct("<4q")
"""A `Command`, and its three numbers."""

HEADER_BYTES = DEFINITIONS_OFFSET = 128
"""After the header, the records of the functions' definitions; after these, those of motions."""

NO_FUNCTION = 0xFFFF
"""In place of a function's index: none is running."""


@dataclass(frozen=True)
class Slot:
    """One value of a motion.

    Attributes:
        function: Index of the function that gives it.
        timestamp: For a quantity, index of the timestamp that picks the moment; else None.
    """

    function: int
    timestamp: int | None = None


def slots_of(roles: Sequence[Role]) -> tuple[Slot, ...]:
    """Return the values of a motion in the order in which they are computed.

    Args:
        roles: The functions' roles, in order.
    """
    by_role = {role: [i for i, own in enumerate(roles) if own is role] for role in Role}
    slots = [Slot(i) for role in (Role.SUCCESS, Role.FITNESS) for i in by_role[role]]
    for h in by_role[Role.TIMESTAMP]:
        slots.append(Slot(h))
        slots.extend(Slot(g, timestamp=h) for g in by_role[Role.QUANTITY])
    slots.extend(Slot(i) for i in by_role[Role.DESCRIPTOR])
    return tuple(slots)


def call_number(call: int, function: int) -> int:
    """Return which call is running as one number, so that one store writes it.

    Args:
        call: Number of the call, counted over the worker's life.
        function: Index of its function, or `NO_FUNCTION`.
    """
    return call << 16 | function


def function_of(number: int) -> int:
    """Return the function's index of a `call_number`."""
    return number & 0xFFFF


@dataclass(frozen=True)
class ColumnPlace:
    """Where one column lies in the shared array.

    Attributes:
        offset: In bytes.
        shape: (N, T, ...).
        dtype: bool or float64.
    """

    offset: int
    shape: tuple[int, ...]
    dtype: np.dtype[Any]

    @property
    def size(self) -> int:
        """Number of its elements."""
        return int(np.prod(self.shape))

    @property
    def end(self) -> int:
        """Where it ends, in bytes, rounded up to whole words."""
        return self.offset + -(-self.size * self.dtype.itemsize // 8) * 8


def column_places(layout: InfoLayout, *, motions: int, moments: int) -> tuple[ColumnPlace, ...]:
    """Return where the columns of a chunk lie, in the layout's order.

    Args:
        layout: The keys.
        motions: Motions in the chunk.
        moments: Moments of each.
    """
    places: list[ColumnPlace] = []
    for key in layout.keys:
        offset = places[-1].end if places else 0
        places.append(ColumnPlace(offset, (motions, moments, *key.shape), key.dtype))
    return tuple(places)


def records_offset(functions: int) -> int:
    """Return where the records of the motions begin, in bytes."""
    return HEADER_BYTES + functions * RECORD.itemsize


def results_bytes(functions: int, slots: int) -> int:
    """Return the size of the array of results, in bytes."""
    return records_offset(functions) + CAPACITY * slots * RECORD.itemsize
