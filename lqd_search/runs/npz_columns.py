"""The columns of an npz file, read with care: whatever is damaged is one error."""

import io
import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lqd_envs import LQDError

_END_RECORD = 22


class ColumnError(LQDError):
    """A file's columns cannot be read or have another form; the text says why, in half a line."""


def read_columns(path: Path) -> dict[str, NDArray[Any]]:
    """Read every array of an npz file.

    Args:
        path: The file.

    Returns:
        The arrays by name.

    Raises:
        ColumnError: The file is missing, damaged or none of this form.
    """
    try:
        content = path.read_bytes()
        with zipfile.ZipFile(io.BytesIO(content)) as file:
            # The whole of a member, since only then its checksum is compared.
            members = {name: file.read(name) for name in file.namelist()}
        _check_number(len(members), content)
        return {
            name.removesuffix(".npy"): np.lib.format.read_array(
                io.BytesIO(content), allow_pickle=False
            )
            for name, content in members.items()
        }
    # What zipfile raises for files that are damaged here or there: RuntimeError where a member
    # passes for encrypted, or packed in a way that it does not know.
    except (OSError, EOFError, ValueError, RuntimeError, zipfile.BadZipFile, zlib.error) as error:
        reason = error.strerror if isinstance(error, OSError) else None
        raise ColumnError(reason or " ".join(str(error).split()) or "it ends too early") from error


def _check_number(members: int, content: bytes) -> None:
    # A damaged byte in a zip's directory may hide what comes after it. How many members there are
    # is said once more in its last record, behind which NumPy writes no comment.
    number = int.from_bytes(content[-_END_RECORD:][10:12], "little")
    if members != number:
        raise ColumnError(f"expected {number} columns, but there are {members}")


def column_of(
    columns: Mapping[str, NDArray[Any]], name: str, *, dtype: type[np.generic], ndim: int
) -> NDArray[Any]:
    """Return one column, checked.

    Args:
        columns: The arrays by name.
        name: The column's name.
        dtype: The dtype that it must have.
        ndim: The number of dimensions that it must have.

    Raises:
        ColumnError: It is missing, or has another dtype or number of dimensions.
    """
    if name not in columns:
        raise ColumnError(f"expected a column {name}, but there is none")
    column = columns[name]
    if column.dtype != dtype or column.ndim != ndim:
        raise ColumnError(
            f"expected {ndim} dimensions of {np.dtype(dtype)} in {name}, got {column.ndim} of "
            f"{column.dtype}"
        )
    return column
