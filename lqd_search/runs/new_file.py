"""Whether a new file can be made at a path."""

from pathlib import Path


def why_no_new_file(path: Path) -> str | None:
    """Return why no new file can be made there, to be known before work is spent on it.

    Returns:
        What is said of the path in a sentence, such as "exists already"; None where it can.
    """
    try:
        path.lstat()
    except FileNotFoundError:
        there = path.absolute().parent.is_dir()
        return None if there else "is in a folder that does not exist"
    except OSError as error:
        return f"cannot be used ({error.strerror})"
    return "exists already"
