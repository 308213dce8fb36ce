"""Trying one layer of the sandbox for real. This file runs in a process of its own."""

import contextlib
import mmap
import os
import resource
import socket
import subprocess
import sys
from collections.abc import Callable
from typing import Any

import numpy as np

from lqd_llm.sandbox.capabilities import drop_capabilities
from lqd_llm.sandbox.landlock import apply_landlock, landlock_version
from lqd_llm.sandbox.libc import mprotect, syscall
from lqd_llm.sandbox.rlimits import address_space, apply_rlimits
from lqd_llm.sandbox.seccomp import apply_seccomp

HELD = "held"
"""Written when everything that the layer forbids has failed."""
LAST = "last"
"""Written before a last attempt, which ends the process if the layer holds."""

_MEMORY = 64 << 20
_SECURE_BITS = 0x1FF
_TCP_FROM = 4


class _OpenError(Exception):
    """Something that the layer forbids was done."""


def main(order: dict[str, Any]) -> None:
    """Try one layer, and write a line of what came of it.

    Args:
        order: `layer`, its name; `columns`, a file descriptor and the size of shared columns; and
            `environment`, the names of variables that may be there.
    """
    try:
        _PROBES[order["layer"]](order)
    except OSError as error:
        _say(f"it cannot be put on: {error}")
    except _OpenError as error:
        _say(f"it does not hold: {error}")
    else:
        _say(HELD)


def _process(order: dict[str, Any]) -> None:
    # Python itself adds the last one where the environment says nothing of languages.
    known = {*order["environment"], "LC_CTYPE"}
    _expect(set(os.environ) <= known, "the user's environment is there")
    _expect(os.getsid(0) == os.getpid(), "the process is not in a session of its own")
    _fails(lambda: os.open("/dev/tty", os.O_RDWR), "it has a terminal")
    _expect(_open_files() <= {0, 1, 2}, "files of the host are open")


def _open_files() -> set[int]:
    found = set()
    for file in range(256):
        try:
            os.fstat(file)
        except OSError:
            continue
        found.add(file)
    return found


def _columns(order: dict[str, Any]) -> None:
    file, size = order["columns"]
    columns = mmap.mmap(file, size, access=mmap.ACCESS_READ)
    _expect(columns[0] == 1, "they cannot be read")
    address = np.frombuffer(columns, np.uint8).ctypes.data
    _fails(lambda: mprotect(address, size, mmap.PROT_WRITE), "they can be made writable")
    _fails(lambda: mmap.mmap(file, size, access=mmap.ACCESS_WRITE), "they can be written to")
    _fails(lambda: os.pwrite(file, b"2", 0), "they can be written to")
    _fails(lambda: os.ftruncate(file, 0), "they can be shortened")


def _capabilities(_: dict[str, Any]) -> None:
    drop_capabilities()
    with open("/proc/self/status", encoding="ascii") as file:  # noqa: PTH123
        status = dict(line.rstrip("\n").split(":\t", 1) for line in file if ":\t" in line)
    _expect(int(status["CapEff"], 16) == 0, "capabilities are left")
    _expect(int(status["CapPrm"], 16) == 0, "capabilities can be taken back")
    _expect(status["NoNewPrivs"].strip() == "1", "a program could give new rights")


def _rlimits(_: dict[str, Any]) -> None:
    file = os.memfd_create("probe") if hasattr(os, "memfd_create") else 1
    with contextlib.suppress(OSError):
        # Whoever has the rights of a superuser can raise limits again.
        drop_capabilities()
    apply_rlimits(address_space() + _MEMORY, files=3)
    _fails(lambda: bytearray(2 * _MEMORY), "memory has no limit", error=MemoryError)
    if file != 1:
        _fails(lambda: os.write(file, b"."), "files can grow")
    _fails(lambda: os.dup(1), "files can be opened")
    _fails(
        lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (1, 1)),
        "limits can be raised",
        error=(OSError, ValueError),
    )


def _landlock(_: dict[str, Any]) -> None:
    version = landlock_version()
    apply_landlock()
    _fails(lambda: os.open("/", os.O_RDONLY), "folders can be read")
    _fails(lambda: os.open("/proc/self/status", os.O_RDONLY), "files can be read")
    _fails(lambda: os.mkdir("/tmp/sandbox_probe"), "folders can be made")  # noqa: PTH102
    _fails(lambda: subprocess.run([sys.executable, "-c", ""], check=True), "programs can be run")
    if version >= _TCP_FROM:
        with socket.socket() as tcp:
            _fails(lambda: tcp.bind(("127.0.0.1", 0)), "it can listen", error=PermissionError)


def _seccomp(_: dict[str, Any]) -> None:
    executable = mmap.PROT_READ | mmap.PROT_EXEC
    apply_seccomp(answers=1)
    _fails(lambda: os.open("/", os.O_RDONLY), "files can be opened")
    _fails(lambda: os.kill(os.getppid(), 0), "signals can be sent")
    _fails(lambda: mmap.mmap(-1, 4096, prot=executable), "memory can be made executable")
    _fails(lambda: os.dup(1), "files can be duplicated")
    _fails(lambda: syscall(_SECURE_BITS), "an unknown call is answered")
    _say(LAST)
    os.fork()
    raise _OpenError("a process can be started")


def _expect(condition: bool, otherwise: str) -> None:
    if not condition:
        raise _OpenError(otherwise)


def _fails(
    attempt: Callable[[], object],
    otherwise: str,
    *,
    error: type[BaseException] | tuple[type[BaseException], ...] = OSError,
) -> None:
    try:
        attempt()
    except error:
        return
    raise _OpenError(otherwise)


def _say(line: str) -> None:
    os.write(1, (line + "\n").encode())


_PROBES: dict[str, Callable[[dict[str, Any]], None]] = {
    "process": _process,
    "columns": _columns,
    "capabilities": _capabilities,
    "rlimits": _rlimits,
    "landlock": _landlock,
    "seccomp": _seccomp,
}
