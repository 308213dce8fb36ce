"""Seeing to it that no two processes write in the same folder."""

import fcntl
import os
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path


@contextmanager
def folder_locked(path: Path) -> Iterator[bool]:
    """Make a folder, or find it, and hold it for the length of a `with` block.

    The system lets go of it with the process, however that ends.

    Args:
        path: The folder.

    Yields:
        Whether this process alone holds it; where it cannot be known, it does.

    Raises:
        OSError: The folder can neither be made nor opened.
    """
    path.mkdir(parents=True, exist_ok=True)
    with _opened(path) as folder:
        yield _lock(folder, fcntl.LOCK_EX | fcntl.LOCK_NB)


@contextmanager
def folder_in_turn(path: Path) -> Iterator[None]:
    """Make a folder, or find it, and hold it for a moment, after all who hold it now.

    Where it may be written in but not be listed, nobody is kept out.

    Args:
        path: The folder.

    Raises:
        OSError: The folder cannot be made.
    """
    path.mkdir(parents=True, exist_ok=True)
    with ExitStack() as stack:
        with suppress(PermissionError):
            _lock(stack.enter_context(_opened(path)), fcntl.LOCK_EX)
        yield


@contextmanager
def _opened(path: Path) -> Iterator[int]:
    folder = os.open(path, os.O_RDONLY | os.O_DIRECTORY)
    try:
        yield folder
    finally:
        os.close(folder)


def _lock(folder: int, how: int) -> bool:
    try:
        fcntl.flock(folder, how)
    except BlockingIOError:
        return False
    except OSError:
        # Some network file systems know no locks, or none of folders; there, nobody is kept out.
        return True
    return True
