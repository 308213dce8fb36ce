"""The checkpoint of a run: one file that holds its state after a generation."""

import hashlib
import re
from collections.abc import Iterable
from os import PathLike
from pathlib import Path
from shlex import quote
from typing import Any

from lqd_envs import LQDError
from lqd_envs.atomic_file import write_atomically
from lqd_search.runs.state_pickle import (
    StateError,
    Trusted,
    UntrustedNameError,
    pickle_state,
    unpickle_state,
)

CHECKPOINT_FORMAT = 2
"""Version of a checkpoint's form; a reader refuses one that it does not know."""

_MAGIC = b"lqd checkpoint\n"
_VERSION = re.compile(rb"format ([0-9]{1,9})\n")
_BODY = re.compile(rb"length ([0-9]{1,18})\nsha256 ([0-9a-f]{64})\n")


class CheckpointError(LQDError):
    """A checkpoint that cannot be written or read."""


class NoCheckpointError(CheckpointError):
    """There is no checkpoint."""


def save_checkpoint(
    path: str | PathLike[str], state: Any, *, trusted: Iterable[Trusted] = ()
) -> None:
    """Write the state of a run; whatever happens, there is a whole checkpoint, this or the last.

    Args:
        path: The file, in a folder that exists.
        state: What `pickle_state` takes: plain Python values, NumPy's arrays and generators, and
            instances of this project's and pyribs' classes.
        trusted: Further classes and functions that it may name.

    Raises:
        CheckpointError: It cannot be written, or the state holds something else.
    """
    path = Path(path)
    try:
        body = pickle_state(state, trusted=trusted)
    except StateError as error:
        raise CheckpointError(
            f"Expected a state that a checkpoint can hold, but {error}; if it is harmless, add it "
            "to the lists in lqd_search/runs/state_pickle.py, or pass it as trusted."
        ) from error
    head = b"%sformat %d\nlength %d\nsha256 %s\n" % (
        _MAGIC,
        CHECKPOINT_FORMAT,
        len(body),
        hashlib.sha256(body).hexdigest().encode(),
    )
    try:
        write_atomically(path, [head, body])
    except OSError as error:
        raise CheckpointError(
            f"Expected to write the checkpoint {path}, but that failed "
            f"({error.strerror or error}); the last checkpoint is untouched: make space or make "
            f"the folder writable, then go on with `lqd run --resume {quote(str(path.parent))}`."
        ) from error


def load_checkpoint(path: str | PathLike[str], *, trusted: Iterable[Trusted] = ()) -> Any:
    """Read the state of a run.

    The hash finds damage, not malice: whoever changes a checkpoint can change its hash too. What a
    checkpoint from somebody else can do, and what not, is said at `unpickle_state`.

    Args:
        path: The file.
        trusted: As it was given to `save_checkpoint`.

    Returns:
        The state. Its class is to be checked: a file can hold any state.

    Raises:
        NoCheckpointError: There is no such file.
        CheckpointError: It is damaged, of another form, or names what no checkpoint may name.
    """
    path = Path(path)
    try:
        content = path.read_bytes()
    except FileNotFoundError as error:
        raise NoCheckpointError(
            f"Expected a checkpoint at {path}, but there is none; begin the run again from its "
            "start, or pass the folder of a run that has finished a generation."
        ) from error
    except OSError as error:
        raise _unreadable(path, error.strerror or str(error)) from error
    try:
        return unpickle_state(_body(path, memoryview(content)), trusted=trusted)
    except UntrustedNameError as error:
        raise CheckpointError(
            f"Expected a checkpoint in {path} that names nothing but what is trusted, but {error}; "
            "pass it to load_checkpoint as trusted, as it was to save_checkpoint, if you trust the "
            "file. A run of `lqd run` never names it: begin that again."
        ) from error
    except StateError as error:
        raise _unreadable(path, str(error)) from error


def _body(path: Path, content: memoryview) -> memoryview:
    if content[: len(_MAGIC)] != _MAGIC:
        raise _unreadable(path, "it does not begin like one")
    version = _VERSION.match(content, len(_MAGIC))
    if version is None:
        raise _unreadable(path, "its head is damaged")
    if int(version[1]) != CHECKPOINT_FORMAT:
        raise CheckpointError(
            f"Expected the checkpoint format {CHECKPOINT_FORMAT} in {path}, got "
            f"{int(version[1])}; delete it to begin the run again from its start, or go on with "
            "the sources of lqd-envs that wrote it."
        )
    head = _BODY.match(content, version.end())
    if head is None:
        raise _unreadable(path, "its head is damaged")
    length, body = int(head[1]), content[head.end() :]
    if len(body) != length:
        raise _unreadable(path, f"it has {len(body)} bytes after its head instead of {length}")
    if hashlib.sha256(body).hexdigest().encode() != head[2]:
        raise _unreadable(path, "its bytes are others than were written")
    return body


def _unreadable(path: Path, reason: str) -> CheckpointError:
    return CheckpointError(
        f"Expected a checkpoint in {path}, but it cannot be read ({reason}); restore the file, or "
        "delete it to begin the run again from its start, which gives the same result with the "
        "same seed."
    )
