"""Replacing a file as a whole, so that the process may end at any moment."""

import errno
import os
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import TypeAlias

Chunk: TypeAlias = bytes | bytearray | memoryview


def write_atomically(path: Path, content: Chunk | Sequence[Chunk]) -> None:
    """Write a file so that at any moment the old or the new one is there, complete.

    It is written beside its place, as the hidden file `.<name>.part`, brought to the disk and then
    moved. Where the process is killed or the power fails, the part may be left, and nothing else;
    the next call overwrites it. Two processes must not write the same file at the same time.

    Args:
        path: The file, in a folder that exists.
        content: What shall be in it, whole or in pieces.

    Raises:
        OSError: It cannot be written. The part is removed; the old file is untouched, unless all
            that failed was to bring the move itself to the disk.
    """
    part = path.with_name(f".{path.name}.part")
    pieces = [content] if isinstance(content, Chunk) else content
    complete = False
    try:
        with part.open("wb") as file:
            for piece in pieces:
                file.write(piece)
            file.flush()
            os.fsync(file.fileno())
        part.replace(path)
        complete = True
    finally:
        if not complete:
            with suppress(OSError):
                part.unlink()
    sync_folder(path.parent)


def sync_folder(path: Path) -> None:
    """Bring to the disk what was made, moved and removed in a folder.

    Raises:
        OSError: That failed.
    """
    folder = os.open(path, os.O_RDONLY | os.O_DIRECTORY)
    try:
        os.fsync(folder)
    except OSError as error:
        # Some network file systems cannot do this for a folder, and see to it themselves.
        if error.errno not in (errno.EINVAL, errno.ENOTSUP):
            raise
    finally:
        os.close(folder)
