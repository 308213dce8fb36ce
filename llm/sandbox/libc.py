"""System calls that Python has no function for."""

import ctypes
import os
import sys
from typing import Any

PR_SET_PDEATHSIG = 1
PR_SET_SECCOMP = 22
PR_CAPBSET_DROP = 24
PR_SET_NO_NEW_PRIVS = 38


def prctl(option: int, *arguments: int | Any) -> int:
    """Change how the kernel treats this process.

    Args:
        option: One of the `PR_` numbers.
        *arguments: Whole numbers, or pointers made by ctypes; the rest are 0.

    Raises:
        OSError: It failed, or this is not Linux.
    """
    _require_linux("prctl")
    padded = [*arguments, *[0] * (4 - len(arguments))]
    result: int = _library().prctl(option, *map(_long, padded))
    return _checked(result, name="prctl")


def syscall(number: int, *arguments: int | Any) -> int:
    """Make a system call.

    Args:
        number: Its number on this machine.
        *arguments: Whole numbers, or pointers made by ctypes.

    Raises:
        OSError: It failed, or this is not Linux.
    """
    _require_linux("syscall")
    result: int = _library().syscall(ctypes.c_long(number), *map(_long, arguments))
    return _checked(result, name=f"system call {number}")


def mprotect(address: int, size: int, protection: int) -> int:
    """Change what may be done with mapped memory.

    Args:
        address: Where a mapping begins.
        size: Its size in bytes.
        protection: What may be done with it, `mmap.PROT_` numbers.

    Raises:
        OSError: It failed.
    """
    result: int = _library().mprotect(
        ctypes.c_void_p(address), ctypes.c_size_t(size), ctypes.c_int(protection)
    )
    return _checked(result, name="mprotect")


def _library() -> ctypes.CDLL:
    return ctypes.CDLL(None, use_errno=True)


def _long(argument: int | Any) -> Any:
    return ctypes.c_ulong(argument) if isinstance(argument, int) else argument


def _require_linux(name: str) -> None:
    if sys.platform != "linux":
        raise OSError(f"{name} exists on Linux only, and this is {sys.platform}")


def _checked(result: int, *, name: str) -> int:
    if result < 0:
        number = ctypes.get_errno()
        raise OSError(number, f"{name}: {os.strerror(number)}")
    return result
