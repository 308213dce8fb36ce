"""Landlock: no path can be opened, made or removed any more. This file runs in the worker."""

import ctypes
import os
import struct

from lqd_llm.sandbox.libc import PR_SET_NO_NEW_PRIVS, prctl, syscall

# The same on every architecture.
_CREATE_RULESET = 444
_RESTRICT_SELF = 446
_ASK_VERSION = 1

# How many rights of the file system each version of Landlock knows.
_FILE_RIGHTS = {1: 13, 2: 14, 3: 15, 4: 15, 5: 16}
_TCP_RIGHTS = 0b11
_SCOPES = 0b11


def landlock_version() -> int:
    """Return the version of Landlock that the kernel has.

    Raises:
        OSError: The kernel has none, or it is turned off.
    """
    return syscall(_CREATE_RULESET, 0, 0, _ASK_VERSION)


def apply_landlock() -> None:
    """Forbid this process every right that the kernel's Landlock knows, with no exception.

    These are opening, making, renaming, removing and executing files, and where the kernel is new
    enough TCP, sockets without a path, and signals to other processes. Files that are open stay so.

    Raises:
        OSError: The kernel has no Landlock, or it is turned off.
    """
    version = landlock_version()
    rights = (1 << _FILE_RIGHTS.get(version, max(_FILE_RIGHTS.values()))) - 1
    words = [rights]
    if version >= 4:
        words.append(_TCP_RIGHTS)
    if version >= 6:
        words.append(_SCOPES)
    attributes = ctypes.create_string_buffer(struct.pack(f"={len(words)}Q", *words))
    ruleset = syscall(_CREATE_RULESET, attributes, 8 * len(words), 0)
    try:
        prctl(PR_SET_NO_NEW_PRIVS, 1)
        syscall(_RESTRICT_SELF, ruleset, 0)
    finally:
        os.close(ruleset)
