"""Seeing to it that no two processes write the same run."""

import errno
import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from lqd_search.runs.run_folder_error import RunFolderError, cannot_write

_NO_LOCKS = (errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP)


@contextmanager
def locked(path: Path) -> Iterator[None]:
    """Keep other processes from going on with a run, for the length of a `with` block.

    The system ends the lock with the process, however that ends. On a file system that knows no
    locks there is none.

    Args:
        path: The run's `config.json`, which every run has from its beginning.

    Raises:
        RunFolderError: Another process goes on with the run, or the folder cannot be written.
    """
    try:
        # For writing, since a lock over NFS needs that.
        descriptor = os.open(path, os.O_RDWR)
    except OSError as error:
        raise cannot_write(path, error, folder=path.parent) from error
    try:
        _lock(descriptor, path.parent)
        yield
    finally:
        os.close(descriptor)


def _lock(descriptor: int, folder: Path) -> None:
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError as error:
        raise RunFolderError(
            f"Expected to be the only one that goes on with the run in {folder}, but another "
            "process does; wait until it ends, or stop it."
        ) from error
    except OSError as error:
        if error.errno not in _NO_LOCKS:
            raise cannot_write(folder, error, folder=folder) from error
