"""Writing a file as a whole, so that the process may end at any moment."""

import os
from pathlib import Path


def write_atomically(path: Path, content: bytes) -> None:
    """Write a file so that at any moment the old or the new one is there, complete.

    It is written beside its place, as the hidden file `.<name>.part`, brought to the disk and then
    moved. Two processes must not write the same file at the same time.

    Args:
        path: The file, in a folder that exists.
        content: What shall be in it.

    Raises:
        OSError: It cannot be written.
    """
    part = path.with_name(f".{path.name}.part")
    try:
        with part.open("wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)
