"""One worker process, as the host sees it: starting, asking, watching and ending it."""

import contextlib
import json
import os
import select
import subprocess
import sys
import time
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from enum import Enum
from pathlib import Path
from typing import IO, Any, cast

import numpy as np

from lqd_llm.sandbox.errors import SandboxError
from lqd_llm.sandbox.limits import Limits
from lqd_llm.sandbox.shared_memory import SharedMemory
from lqd_llm.sandbox.wire import COMMAND, Command, Order, Word

_TICK = 0.05
# Where a limit on the address space holds, it is met first.
_SLACK = 64 << 20
# Until its locks are on, nothing but our own code runs in it.
_START = Limits(cpu_seconds=60.0, idle_seconds=120.0)


class Ending(Enum):
    """How the worker came out of what it was asked for."""

    ANSWERED = "answered"
    TIMEOUT = "timeout"
    """One call used more CPU time than it may; the worker was killed."""
    MEMORY = "memory"
    """It took more memory than it may; the worker was killed."""
    DIED = "died"
    """It ended by itself, or was killed by somebody else."""
    STILL = "still"
    """It used no CPU time for long, as when somebody else stops it; it was killed."""


@dataclass(frozen=True)
class Ended:
    """What came of asking the worker for something.

    Attributes:
        ending: How it ended.
        call: What the header said was running when this was decided.
    """

    ending: Ending
    call: int


_LATE = {
    Ending.TIMEOUT: "it did not get ready within {0.cpu_seconds:g} s of CPU time",
    Ending.STILL: "it did not get ready, and stood still for {0.idle_seconds:g} s",
}


def start_command(part: str, order: Mapping[str, Any]) -> list[str]:
    """Return the command line of a fresh interpreter that runs one of the sandbox's programs.

    It reads no settings, no environment and no site packages but NumPy's folder.

    Args:
        part: The program's module in this package.
        order: What it is told.

    Raises:
        SandboxError: Python does not know its own interpreter, as where it is embedded.
    """
    if not sys.executable:
        raise SandboxError(
            "Expected Python to know its own interpreter, to start a worker with, but "
            "sys.executable is empty; run this with the python command."
        )
    folder = Path(__file__).parent
    libraries = Path(np.__file__).parent.parent
    arguments = [folder / "start.py", __package__, folder, libraries, part, json.dumps(order)]
    # As -I, which would not let us fix the seed of hashes: the order of a set of strings must be
    # the same in every worker, or a value could change when a worker is replaced.
    return [sys.executable, *("-s", "-P", "-S", "-B"), *map(str, arguments)]


ENVIRONMENT = {
    "PYTHONHASHSEED": "0",
    **dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1"),
}
"""All of the environment that a worker starts with; it empties even this before it is locked."""


class WorkerProcess:
    """A running worker. It ends with the thread that started it, or when it is closed.

    Args:
        columns: The shared columns.
        results: The shared results.
        limits: What a function may use.

    Attributes:
        pid: The process.

    Raises:
        OSError: The system starts no process.
        SandboxError: Python does not know its own interpreter.
    """

    def __init__(self, *, columns: SharedMemory, results: SharedMemory, limits: Limits) -> None:
        order = Order(
            parent=os.getpid(),
            columns=(columns.file, columns.size),
            results=(results.file, results.size),
            memory_bytes=limits.memory_bytes,
        )
        self._words = results
        self._limits = limits
        self._process = subprocess.Popen(
            start_command("worker", asdict(order)),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            bufsize=0,
            pass_fds=(columns.file, results.file),
            env=ENVIRONMENT,
            cwd="/",
            start_new_session=True,
        )
        self.pid = self._process.pid
        self._grown = sys.maxsize

    def wait_until_ready(self) -> tuple[Ended, str]:
        """Wait until the worker has locked itself in.

        Returns:
            Whether it came so far, and what it said of locks that are missing or of its failing.
        """
        ended = self._wait(Command.READY, _START)
        told = self._told() or _LATE.get(ended.ending, "").format(_START)
        self._grown = _resident_bytes(self.pid) + self._limits.memory_bytes + _SLACK
        return ended, told

    def ask(self, command: Command, *numbers: int, text: bytes = b"") -> Ended:
        """Ask for something, and wait until it is done or the worker is no more.

        Args:
            command: What to ask for.
            *numbers: Its numbers, at most three.
            text: Its text, whose length is then the first number.

        Raises:
            SandboxError: The worker answered something else.
        """
        padded = (*numbers, *[0] * (3 - len(numbers)))
        # A worker that is no more is noticed by the wait.
        with contextlib.suppress(BrokenPipeError):
            self._send(COMMAND.pack(command, *padded) + text)
        return self._wait(command, self._limits)

    def close(self) -> None:
        """End the worker at once; a second time does nothing."""
        self._process.kill()
        self._process.wait()
        for stream in (self._process.stdin, self._process.stdout, self._process.stderr):
            if stream is not None:
                stream.close()

    def _send(self, message: bytes) -> None:
        stream, rest = self._stream(self._process.stdin), memoryview(message)
        while rest:
            rest = rest[stream.write(rest) :]

    def _wait(self, command: Command, limits: Limits) -> Ended:
        answers = self._stream(self._process.stdout)
        poller = select.poll()
        poller.register(answers, select.POLLIN)
        watch = _Watch(limits, pid=self.pid, grown=self._grown)
        tick = min(_TICK, limits.cpu_seconds / 4)
        while not poller.poll(1000 * tick):
            call = self._call()
            ending = watch.look(call)
            if ending is not None:
                self._process.kill()
                self._process.wait()
                return Ended(ending, call)
        answer = answers.read(1)
        if not answer:
            self._process.kill()
            self._process.wait()
            return Ended(Ending.DIED, self._call())
        if answer[0] != command:
            raise SandboxError(
                f"Expected the sandbox's worker to answer {int(command)}, but it answered "
                f"{answer[0]}; its results are not used."
            )
        return Ended(Ending.ANSWERED, self._call())

    def _call(self) -> int:
        return int(self._words.array(np.dtype("<u8"), size=1, offset=8 * Word.CALL)[0])

    def _told(self) -> str:
        """Read what a starting worker wrote of itself; nobody listens to it afterwards."""
        stream = self._stream(self._process.stderr)
        os.set_blocking(stream.fileno(), False)
        told = (stream.read(10_000) or b"").decode(errors="replace").strip()
        stream.close()
        return told

    @staticmethod
    def _stream(stream: IO[bytes] | None) -> IO[bytes]:
        return cast("IO[bytes]", stream)


class _Watch:
    """Decides from outside when a worker has used more than it may."""

    def __init__(self, limits: Limits, *, pid: int, grown: int) -> None:
        self._limits = limits
        self._pid = pid
        self._grown = grown
        self._call = -1
        self._cpu_at_call = 0.0
        self._cpu = -1.0
        self._progress = 0.0

    def look(self, call: int) -> Ending | None:
        cpu, now = _cpu_seconds(self._pid), time.monotonic()
        if call != self._call:
            # The call began before it was first seen here, so what is counted is too little.
            self._call, self._cpu_at_call = call, cpu
        if cpu != self._cpu:
            self._cpu, self._progress = cpu, now
        if cpu - self._cpu_at_call > self._limits.cpu_seconds:
            return Ending.TIMEOUT
        if now - self._progress > self._limits.idle_seconds:
            # No function can be at a standstill by itself: it has nothing to wait for.
            return Ending.STILL
        return Ending.MEMORY if _resident_bytes(self._pid) > self._grown else None


def _cpu_seconds(pid: int) -> float:
    """Return the CPU time that a process has used; the time on the wall where that is unknown."""
    if sys.platform != "linux":
        return time.monotonic()
    try:
        # The clock of another process, as clock_getcpuclockid(3) makes it.
        return time.clock_gettime((~pid << 3) | 2)
    except OSError:
        return 0.0


def _resident_bytes(pid: int) -> int:
    try:
        pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
    except (OSError, IndexError):
        return 0
    return pages * os.sysconf("SC_PAGE_SIZE")
