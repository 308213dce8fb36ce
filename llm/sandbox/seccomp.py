"""Seccomp: the kernel answers only the few system calls that calculating needs.

This file runs in the worker. What is not on the list fails with EPERM and does not end the worker,
so that a library which tries something it can do without (asking for the number of CPUs, say) goes
on. Only what no calculation ever tries ends it at once: another program, another process, a socket,
another process's memory, and calls by the numbers of another architecture.
"""

import ctypes
import errno
import platform
import struct
import sys
from collections.abc import Iterator
from dataclasses import dataclass

from lqd_llm.sandbox.libc import PR_SET_NO_NEW_PRIVS, PR_SET_SECCOMP, prctl
from lqd_llm.sandbox.system_calls import ALLOWED, CHECKED, FATAL

_MODE_FILTER = 2
_ALLOW = 0x7FFF0000
_KILL_PROCESS = 0x80000000
_REFUSE = 0x00050000 | errno.EPERM

# Classic BPF: load a word of the call, compare it with a number, return the verdict.
_LOAD = 0x20
_JUMP_EQUAL = 0x15
_JUMP_AT_LEAST = 0x35
_JUMP_ANY_BIT = 0x45
_RETURN = 0x06

_NUMBER_AT = 0
_ARCHITECTURE_AT = 4
_FIRST_ARGUMENT_AT = 16
_X32 = 0x40000000

_PROT_EXEC = 0x4
_MAP_ANONYMOUS = 0x20

_ARCHITECTURES = {"x86_64": 0xC000003E, "aarch64": 0xC00000B7}
_PLACES = {"x86_64": 0, "aarch64": 1}


@dataclass(frozen=True)
class _Argument:
    """A condition on the low word of an argument: equal to a number, or with or without bits."""

    place: int
    jump: int
    number: int
    wanted: bool


_CONDITIONS = {
    "read": (_Argument(0, _JUMP_EQUAL, 0, True),),
    "mmap": (
        _Argument(2, _JUMP_ANY_BIT, _PROT_EXEC, False),
        _Argument(3, _JUMP_ANY_BIT, _MAP_ANONYMOUS, True),
    ),
    "mprotect": (_Argument(2, _JUMP_ANY_BIT, _PROT_EXEC, False),),
}


def apply_seccomp(*, answers: int) -> None:
    """Install the filter in this process, which must have no other thread.

    Args:
        answers: The one file descriptor that can be written to.

    Raises:
        OSError: The kernel has no seccomp, or this is not Linux on x86-64 or aarch64.
    """
    if sys.platform != "linux" or platform.machine() not in _ARCHITECTURES:
        raise OSError(f"no filter for {platform.machine()} on {sys.platform}")
    program = b"".join(filter_program(platform.machine(), answers=answers))
    instructions = ctypes.create_string_buffer(program, len(program))
    # struct sock_fprog: the number of instructions, and where they are.
    header = struct.pack("@HP", len(program) // 8, ctypes.addressof(instructions))
    prctl(PR_SET_NO_NEW_PRIVS, 1)
    prctl(PR_SET_SECCOMP, _MODE_FILTER, ctypes.create_string_buffer(header, len(header)))


def filter_program(machine: str, *, answers: int) -> Iterator[bytes]:
    """Yield the instructions of the filter, 8 bytes each.

    Args:
        machine: `"x86_64"` or `"aarch64"`.
        answers: As of `apply_seccomp`.
    """
    place = _PLACES[machine]
    yield _instruction(_LOAD, _ARCHITECTURE_AT)
    yield _instruction(_JUMP_EQUAL, _ARCHITECTURES[machine], if_true=1)
    yield _instruction(_RETURN, _KILL_PROCESS)
    yield _instruction(_LOAD, _NUMBER_AT)
    if machine == "x86_64":
        yield _instruction(_JUMP_AT_LEAST, _X32, if_false=1)
        yield _instruction(_RETURN, _KILL_PROCESS)
    for numbers in ALLOWED.values():
        yield from _verdict(numbers[place], _ALLOW)
    conditions = {**_CONDITIONS, "write": (_Argument(0, _JUMP_EQUAL, answers, True),)}
    for name, numbers in CHECKED.items():
        yield from _checked(numbers[place], conditions[name])
    for fatal in FATAL.values():
        number = fatal[place]
        if number is not None:
            yield from _verdict(number, _KILL_PROCESS)
    yield _instruction(_RETURN, _REFUSE)


def _verdict(number: int, verdict: int) -> Iterator[bytes]:
    yield _instruction(_JUMP_EQUAL, number, if_false=1)
    yield _instruction(_RETURN, verdict)


def _checked(number: int, conditions: tuple[_Argument, ...]) -> Iterator[bytes]:
    yield _instruction(_JUMP_EQUAL, number, if_false=3 * len(conditions) + 1)
    for condition in conditions:
        # Words lie low half first on both architectures; what is asked for lies in the low half.
        yield _instruction(_LOAD, _FIRST_ARGUMENT_AT + 8 * condition.place)
        good, bad = (1, 0) if condition.wanted else (0, 1)
        yield _instruction(condition.jump, condition.number, if_true=good, if_false=bad)
        yield _instruction(_RETURN, _REFUSE)
    yield _instruction(_RETURN, _ALLOW)


def _instruction(code: int, number: int, *, if_true: int = 0, if_false: int = 0) -> bytes:
    return struct.pack("<HBBI", code, if_true, if_false, number)
