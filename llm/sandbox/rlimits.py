"""Resource limits of the worker. This file runs in the worker."""

import resource
import sys
from pathlib import Path

CPU_SECONDS = 3600
"""A backstop for a worker that nobody watches; one that reaches it is replaced by a new one."""

_STACK = 8 << 20


def apply_rlimits(memory_bytes: int, *, files: int) -> None:
    """Limit what this process may use; it cannot raise these limits again.

    Args:
        memory_bytes: Memory that it may take, counting the `address_space` that it has by now.
        files: File descriptors that it may have open.

    Raises:
        OSError: The system refuses a limit.
    """
    _limit(resource.RLIMIT_CPU, CPU_SECONDS)
    _limit(resource.RLIMIT_FSIZE, 0)
    _limit(resource.RLIMIT_CORE, 0)
    # The superuser may have more processes all the same; seccomp forbids them to everybody.
    _limit(resource.RLIMIT_NPROC, 0)
    _limit(resource.RLIMIT_MEMLOCK, 0)
    _limit(resource.RLIMIT_STACK, _STACK)
    _limit(resource.RLIMIT_NOFILE, files)
    if sys.platform == "linux":
        for name in ("RLIMIT_MSGQUEUE", "RLIMIT_NICE", "RLIMIT_RTPRIO", "RLIMIT_SIGPENDING"):
            _limit(getattr(resource, name), 0)
        _limit(resource.RLIMIT_AS, memory_bytes)
    else:
        # Elsewhere the address space tells little; the data segment is what can be limited.
        _limit(resource.RLIMIT_DATA, memory_bytes)


def address_space() -> int:
    """Return the size of this process's address space in bytes; 0 where that is not known."""
    if sys.platform != "linux":
        return 0
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    return pages * resource.getpagesize()


def _limit(what: int, most: int) -> None:
    _, hard = resource.getrlimit(what)
    if hard != resource.RLIM_INFINITY:
        most = min(most, hard)
    try:
        resource.setrlimit(what, (most, most))
    except ValueError as error:
        raise OSError(f"the limit {what} cannot be set: {error}") from error
