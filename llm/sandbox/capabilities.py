"""Giving up what a superuser may do. This file runs in the worker."""

import contextlib
import ctypes
import os
import platform
import struct
from itertools import count

from lqd_llm.sandbox.libc import PR_CAPBSET_DROP, PR_SET_NO_NEW_PRIVS, prctl, syscall

_CAPSET = {"x86_64": 126, "aarch64": 91}
_VERSION_3 = 0x20080522


def drop_capabilities() -> None:
    """Give up all capabilities and groups, and the right to gain any by executing a program.

    Raises:
        OSError: It cannot be done here.
    """
    prctl(PR_SET_NO_NEW_PRIVS, 1)
    with contextlib.suppress(PermissionError):
        # Only a superuser may, and only a superuser has anything to lose.
        os.setgroups([])
        _drop_bounding_set()
    number = _CAPSET.get(platform.machine())
    if number is None:
        raise OSError(f"the number of capset is not known on {platform.machine()}")
    header = ctypes.create_string_buffer(struct.pack("=Ii", _VERSION_3, 0))
    nothing = ctypes.create_string_buffer(bytes(24))
    syscall(number, header, nothing)


def _drop_bounding_set() -> None:
    for capability in count():
        try:
            prctl(PR_CAPBSET_DROP, capability)
        except PermissionError:
            raise
        except OSError:
            # The first number that the kernel does not know.
            return
