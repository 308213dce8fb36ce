"""The worker: a process that locks itself in, and only then runs functions it does not trust."""

import fcntl
import gc
import json
import mmap
import os
import signal
import sys
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from lqd_llm.sandbox.capabilities import drop_capabilities
from lqd_llm.sandbox.defined_functions import define_functions
from lqd_llm.sandbox.info_layout import InfoLayout
from lqd_llm.sandbox.infos import InfosBuilder
from lqd_llm.sandbox.landlock import apply_landlock
from lqd_llm.sandbox.libc import PR_SET_PDEATHSIG, prctl
from lqd_llm.sandbox.motion_calls import MotionCalls
from lqd_llm.sandbox.rlimits import address_space, apply_rlimits
from lqd_llm.sandbox.roles import Role
from lqd_llm.sandbox.seccomp import apply_seccomp
from lqd_llm.sandbox.warm_up import warm_up
from lqd_llm.sandbox.wire import (
    COMMAND,
    HEADER_BYTES,
    MAGIC,
    VERSION,
    Command,
    Lock,
    Order,
    Status,
    Word,
    column_places,
    records_offset,
    slots_of,
)

_COMMANDS = 0
# Not 1: linear algebra complains there of what it is given, and would be taken for an answer.
_ANSWERS = 3
# Commands, nothing, where a failing start is told, and answers.
_FILES = 4
# More than a worker ever has, whatever the numbers of those that it is handed.
_MOST_FILES = 32


def main(order: dict[str, Any]) -> None:
    """Lock this process in, and do what the host asks for until it asks no more.

    Args:
        order: The fields of an `Order`.
    """
    told = Order(**order)
    _die_with(told.parent)
    files = [_moved(told.columns[0]), _moved(told.results[0])]
    _move_answers()
    columns = mmap.mmap(files[0], told.columns[1], access=mmap.ACCESS_READ)
    results = mmap.mmap(files[1], told.results[1], access=mmap.ACCESS_WRITE)
    # Mappings last without their files, of which Python keeps copies.
    os.closerange(_FILES, _MOST_FILES)
    warm_up()
    locks = _lock(told)
    words = memoryview(results)[:HEADER_BYTES].cast("Q")
    words[Word.MAGIC], words[Word.VERSION] = MAGIC, VERSION
    words[Word.LOCKS] = int(locks)
    words[Word.STATUS] = int(Status.WORKING)
    _answer(Command.READY)
    try:
        _serve(columns, results)
    except MemoryError:
        words[Word.STATUS] = int(Status.OUT_OF_MEMORY)
        # At once: whatever holds the memory must not be able to stop this from ending.
        os._exit(1)


def _die_with(parent: int) -> None:
    if sys.platform == "linux":
        prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:
        os._exit(1)


def _moved(file: int) -> int:
    """Move a file to a number that nothing else is to have."""
    moved = fcntl.fcntl(file, fcntl.F_DUPFD_CLOEXEC, _FILES)
    os.close(file)
    return moved


def _move_answers() -> None:
    os.dup2(1, _ANSWERS, inheritable=False)
    nothing = os.open(os.devnull, os.O_RDWR)
    os.dup2(nothing, 1)
    os.close(nothing)


def _lock(order: Order) -> Lock:
    """Put on every lock that this system has; the host decides whether they are enough."""
    warnings.simplefilter("ignore")
    np.seterr(all="ignore")
    os.environ.clear()
    gc.collect()
    gc.freeze()
    # Infos hold no cycles, so looking for some every 700 of them is in vain.
    gc.set_threshold(20_000)
    applied = Lock(0)
    for lock, apply in _locks(order):
        try:
            apply()
        except OSError as error:
            print(f"{lock.name}: {error}", file=sys.stderr, flush=True)  # noqa: T201
        else:
            applied |= lock
    return applied


def _locks(order: Order) -> list[tuple[Lock, Callable[[], None]]]:
    memory = address_space() + order.memory_bytes
    # In this order: Landlock needs a file descriptor of its own, which the limits do not leave it,
    # and after seccomp none of the others can be put on.
    return [
        (Lock.CAPABILITIES, drop_capabilities),
        (Lock.LANDLOCK, apply_landlock),
        (Lock.RLIMITS, lambda: apply_rlimits(memory, files=_FILES)),
        (Lock.SECCOMP, lambda: apply_seccomp(answers=_ANSWERS)),
    ]


def _serve(columns: mmap.mmap, results: mmap.mmap) -> None:
    served: _Served | None = None
    while command := _read(COMMAND.size):
        kind, *numbers = COMMAND.unpack(command)
        match kind:
            case Command.DEFINE:
                told = json.loads(_read(numbers[0]))
                served = _Served.define(told, columns=columns, results=results)
            case Command.RUN if served is not None:
                served.run(motions=numbers[0], moments=numbers[1], start=numbers[2])
        _answer(kind)


def _read(size: int) -> bytes:
    """Read so many bytes of commands; none at all once the host is gone."""
    read = bytearray()
    while len(read) < size:
        part = os.read(_COMMANDS, size - len(read))
        if not part:
            return b""
        read += part
    return bytes(read)


def _answer(command: int) -> None:
    os.write(_ANSWERS, bytes([command]))


@dataclass(frozen=True)
class _Served:
    layout: InfoLayout
    infos: InfosBuilder
    calls: MotionCalls
    columns: mmap.mmap
    results: mmap.mmap
    words: memoryview
    records: int

    @classmethod
    def define(cls, told: dict[str, Any], *, columns: mmap.mmap, results: mmap.mmap) -> "_Served":
        words = memoryview(results)[:HEADER_BYTES].cast("Q")
        slots = slots_of([Role(function["role"]) for function in told["functions"]])
        words[Word.FUNCTIONS], words[Word.SLOTS] = len(told["functions"]), len(slots)
        functions = define_functions(told["functions"], results=results, words=words)
        layout = InfoLayout.from_json(told["layout"])
        return cls(
            layout=layout,
            infos=InfosBuilder(layout),
            calls=MotionCalls(functions, words=words),
            columns=columns,
            results=results,
            words=words,
            records=records_offset(len(functions)),
        )

    def run(self, *, motions: int, moments: int, start: int) -> None:
        arrays = [
            np.frombuffer(self.columns, place.dtype, place.size, place.offset).reshape(place.shape)
            for place in column_places(self.layout, motions=motions, moments=moments)
        ]
        for motion in range(start, motions):
            self.calls.write(
                self.infos(arrays, motion),
                into=self.results,
                offset=self.records + motion * self.calls.record_bytes,
            )
            self.words[Word.DONE] = motion + 1
