"""Memory that the host and its worker share."""

import contextlib
import fcntl
import mmap
import os
import tempfile
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lqd_llm.sandbox.errors import SandboxError

# Python names the last of these from 3.13 on.
_SEAL, _SHRINK, _GROW, _FUTURE_WRITE = 1, 2, 4, 16


class SharedMemory:
    """A block of memory of a fixed size, which lasts until it is closed.

    On Linux the block is sealed, so that nobody can shorten it under somebody's feet.

    Args:
        name: What it is for.
        size: In bytes.
        writable: Whether the worker may write to it. If not, only the mapping that is made here
            can be written to, now and for ever.

    Attributes:
        file: The file descriptor that a worker maps it by.
        memory: The host's mapping of it.
        size: In bytes.

    Raises:
        SandboxError: The system gives none.
    """

    def __init__(self, name: str, *, size: int, writable: bool) -> None:
        self.size = size
        try:
            self._make(name, writable=writable)
        except OSError as error:
            raise SandboxError(
                f"Expected {size >> 10} KiB of memory to share with a process, but the system "
                f"gives none ({error}); close files and programs, or raise the limit on open files "
                "(ulimit -n)."
            ) from error

    def _make(self, name: str, *, writable: bool) -> None:
        self.file = _open(name)
        try:
            os.ftruncate(self.file, self.size)
            self.memory = mmap.mmap(self.file, self.size)
            _seal(self.file, writable=writable)
        except BaseException:
            os.close(self.file)
            raise

    def array(self, dtype: np.dtype[Any], *, size: int, offset: int) -> NDArray[Any]:
        """Return a part of the block as an array, which must be let go of before `close`.

        Args:
            dtype: Of its elements.
            size: Number of its elements.
            offset: Where it begins, in bytes.
        """
        return np.frombuffer(self.memory, dtype, size, offset)

    def close(self) -> None:
        """Let go of the block; a second time does nothing."""
        if self.file >= 0:
            # An array that an error's traceback still holds keeps the mapping a little longer.
            with contextlib.suppress(BufferError):
                self.memory.close()
            os.close(self.file)
            self.file = -1


def _open(name: str) -> int:
    if hasattr(os, "memfd_create"):
        return os.memfd_create(name, os.MFD_CLOEXEC | os.MFD_ALLOW_SEALING)
    file, path = tempfile.mkstemp(prefix=name)
    os.unlink(path)  # noqa: PTH108
    return file


def _seal(file: int, *, writable: bool) -> None:
    if not hasattr(fcntl, "F_ADD_SEALS"):
        return
    fcntl.fcntl(file, fcntl.F_ADD_SEALS, _SHRINK | _GROW)
    if not writable:
        # Kernels before 5.1 do not know this seal; there only the worker's mapping is read-only.
        with contextlib.suppress(OSError):
            fcntl.fcntl(file, fcntl.F_ADD_SEALS, _FUTURE_WRITE)
    fcntl.fcntl(file, fcntl.F_ADD_SEALS, _SEAL)
