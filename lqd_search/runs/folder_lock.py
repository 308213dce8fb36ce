"""Seeing to it that no two processes write in the same folder."""

import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager
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
    folder = os.open(path, os.O_RDONLY | os.O_DIRECTORY)
    try:
        yield _lock(folder)
    finally:
        os.close(folder)


def _lock(folder: int) -> bool:
    try:
        fcntl.flock(folder, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        # Some network file systems know no locks, or none of folders; there, nobody is kept out.
        return True
    return True
