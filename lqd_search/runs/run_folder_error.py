"""What goes wrong with the folder of a run."""

from pathlib import Path
from shlex import quote

from lqd_envs import LQDError


class RunFolderError(LQDError):
    """A run folder that cannot be made, written or read."""


def cannot_write(path: Path, error: OSError, *, folder: Path) -> RunFolderError:
    """Return the error for a file of a run in a folder that could not be written."""
    return RunFolderError(
        f"Expected to write {path}, but that failed ({error.strerror or error}); see to the folder "
        f"and its disk, then go on with `lqd run --resume {quote(str(folder))}`: what was finished "
        "is kept."
    )
