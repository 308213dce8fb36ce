"""The file that a report is written to."""

from pathlib import Path

from lqd_envs import LQDError
from lqd_envs.atomic_file import write_atomically
from lqd_search.runs.new_file import why_no_new_file

GENERATOR = "lqd report"
"""What the page's head names as its maker."""

_HEAD = 1_000


def check_report_path(path: Path) -> None:
    """Check, before anything is simulated, that a report may get this name.

    An earlier report is replaced; any other file is left alone.

    Raises:
        LQDError: It is not that of an .html file, is that of another file, cannot be used, or is
            in a folder that does not exist.
    """
    if path.suffix != ".html":
        raise LQDError(
            f"Expected the name of an .html file for the report, got {path}; choose one such as "
            "report.html."
        )
    why = why_no_new_file(path)
    if why is None or _is_report(path):
        return
    raise LQDError(
        f"Expected a new file for the report, or an earlier report, but {path} {why}; choose "
        "another."
    )


def write_report(path: Path, page: str) -> None:
    """Write a report as a whole: it is there complete, or not at all.

    Raises:
        LQDError: It cannot be written.
    """
    try:
        # Names of files may hold bytes that are no text.
        write_atomically(path, page.encode(errors="replace"))
    except OSError as error:
        raise LQDError(
            f"Expected to write the report {path}, but that failed ({error.strerror or error}); "
            "see to its folder and the disk, or choose another with --out."
        ) from error


def _is_report(path: Path) -> bool:
    try:
        if not path.is_file():
            return False
        with path.open("rb") as file:
            return f'content="{GENERATOR}"'.encode() in file.read(_HEAD)
    except OSError:
        # What cannot be read is not replaced.
        return False
