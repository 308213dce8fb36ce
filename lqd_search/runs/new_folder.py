"""Making the folder of a run where there is nothing yet."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from shutil import rmtree
from tempfile import mkdtemp

from lqd_envs.atomic_file import write_atomically
from lqd_search.runs.run_folder_error import RunFolderError


def refuse_existing(path: Path) -> None:
    """Raise an error if there is something at the path of a new run folder.

    Raises:
        RunFolderError: There is, if only a link to nothing, or the path cannot be used.
    """
    try:
        path.lstat()
    except FileNotFoundError:
        return
    except OSError as error:
        raise cannot_make(path, error) from error
    raise RunFolderError(
        f"Expected a new folder for the run, but {path} exists; choose another name, or leave "
        "out --out for a name with the time."
    )


@contextmanager
def folder_beside(path: Path) -> Iterator[Path]:
    """Yield a new folder beside a path, to be filled and moved there; else it is removed."""
    part = Path(mkdtemp(prefix=f".{path.name}.", dir=path.parent))
    try:
        part.chmod(0o777 & ~_umask())
        yield part
    finally:
        # Where it was moved to its place, there is nothing left of it here.
        rmtree(part, ignore_errors=True)


def copy_to_disk(source: str, target: str) -> str:
    """Copy a file and bring it to the disk, so that the one that was copied may be removed."""
    write_atomically(Path(target), Path(source).read_bytes())
    return target


def _umask() -> int:
    # It can only be read by being set.
    mask = os.umask(0o077)
    os.umask(mask)
    return mask


def cannot_make(path: Path, error: OSError) -> RunFolderError:
    """Return the error for the folder of a run that could not be made."""
    return RunFolderError(
        f"Expected to write the run to {path}, but that failed ({error.strerror or error}); choose "
        "a folder that can be written with --out."
    )
