"""Columns of a batch: checking them, and copying a chunk to where the worker can read it."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lqd_llm.sandbox.errors import SandboxError
from lqd_llm.sandbox.info_layout import InfoLayout
from lqd_llm.sandbox.shared_memory import SharedMemory
from lqd_llm.sandbox.wire import CAPACITY, column_places


def check_columns(columns: Mapping[str, NDArray[Any]], layout: InfoLayout) -> tuple[int, int]:
    """Check that columns fit a layout.

    Args:
        columns: The columns by key.
        layout: The keys.

    Returns:
        The numbers of motions and moments.

    Raises:
        SandboxError: A key is missing or another one is there, there is no moment, or a column has
            another shape or dtype.
    """
    keys = [key.key for key in layout.keys]
    if set(columns) != set(keys):
        raise SandboxError(
            f"Expected the columns {', '.join(keys)}, but got {', '.join(columns) or 'none'}."
        )
    for name, column in columns.items():
        if not isinstance(column, np.ndarray) or column.ndim < 2:
            of_shape = f" of shape {column.shape}" if isinstance(column, np.ndarray) else ""
            raise SandboxError(
                f"Expected the column {name!r} to be an array of motions and moments, but got "
                f"{type(column).__name__}{of_shape}."
            )
    motions, moments = columns[keys[0]].shape[:2]
    if moments < 1:
        raise SandboxError("Expected motions of at least one moment, but they have none.")
    for key in layout.keys:
        column, shape = columns[key.key], (motions, moments, *key.shape)
        if column.shape != shape or column.dtype != key.dtype:
            raise SandboxError(
                f"Expected the column {key.key!r} to be {key.dtype} of shape {shape}, but it is "
                f"{column.dtype} of shape {column.shape}."
            )
    return motions, moments


def moment_bytes(layout: InfoLayout) -> int:
    """Return the most bytes that one moment of a motion takes."""
    return sum(int(np.prod(key.shape)) * key.dtype.itemsize + 8 for key in layout.keys)


def chunk_size(layout: InfoLayout, *, moments: int, room: int) -> int:
    """Return how many motions are passed to the worker at a time.

    Args:
        layout: The keys.
        moments: Moments of each motion.
        room: Bytes that are there for them.

    Raises:
        SandboxError: Not even one fits.
    """
    size = min(CAPACITY, room // (moments * moment_bytes(layout)))
    if size < 1:
        raise SandboxError(
            f"Expected motions that fit into {room} bytes, but one of {moments} moments does not; "
            "pass shorter ones."
        )
    return size


def copy_chunk(
    columns: Mapping[str, NDArray[Any]], layout: InfoLayout, *, rows: slice, into: SharedMemory
) -> int:
    """Copy the motions of a chunk into the shared columns.

    Args:
        columns: The columns of the batch, checked.
        layout: The keys.
        rows: The motions.
        into: The shared columns.

    Returns:
        The number of moments of each.
    """
    moments = int(columns[layout.keys[0].key].shape[1])
    places = column_places(layout, motions=rows.stop - rows.start, moments=moments)
    for key, place in zip(layout.keys, places, strict=True):
        shared = into.array(place.dtype, size=place.size, offset=place.offset)
        shared.reshape(place.shape)[...] = columns[key.key][rows]
    return moments
