"""NumPy's arrays, scalars, dtypes and generators as a pickle of a run's state holds them.

NumPy's own pickles rebuild an array by calls that take any dtype and any flags, and with those a
file can make an array whose bytes pass for pointers. These forms can only make numbers and text.
"""

import re
import reprlib
from collections.abc import Callable
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from lqd_envs import LQDError

Reduced: TypeAlias = tuple[Callable[..., Any], tuple[Any, ...]]
"""A function and the arguments with which it makes a value again."""

Description: TypeAlias = str | tuple[Any, ...]
"""A dtype: its name; or a dtype and the shape of a field; or the names, dtypes and offsets of the
fields, the size of an item and whether they are aligned."""

BIT_GENERATORS = ("PCG64", "PCG64DXSM", "SFC64")
"""Those whose states are numbers alone. `MT19937` and `Philox` also hold a place in a buffer, which
they do not check: with another one they read memory that is not theirs."""
_LEAF = re.compile(r"[<>|][biufcmMSU][0-9]+(\[[0-9a-zA-Z]+\])?")


class NumPyStateError(LQDError):
    """A NumPy object that a state cannot hold; the text says which, in half a line."""


def reduce_numpy(value: Any) -> Reduced | None:
    """Return how a NumPy object is made again; None for what is none of them.

    Args:
        value: An array, scalar, dtype, generator, bit generator or seed sequence, or anything.

    Raises:
        NumPyStateError: An array or dtype holds something other than numbers or text.
    """
    if type(value) is np.ndarray:
        return _reduce_array(value)
    if isinstance(value, np.dtype):
        return dtype_of, (describe(value),)
    if isinstance(value, np.generic) and type(value) is value.dtype.type:
        return scalar_of, (describe(value.dtype), _without_gaps(np.asarray(value)).tobytes())
    return _reduce_random(value)


def describe(dtype: np.dtype[Any]) -> Description:
    """Return what makes a dtype again.

    Raises:
        NumPyStateError: It is none of numbers, text or records of them.
    """
    if dtype.subdtype is not None:
        inner, shape = dtype.subdtype
        return describe(inner), shape
    if dtype.names is not None and dtype.fields is not None:
        fields = [dtype.fields[name] for name in dtype.names]
        if any(len(field) > 2 for field in fields):
            raise NumPyStateError(f"it holds the dtype {dtype}, whose fields have titles")
        inners = tuple(describe(field[0]) for field in fields)
        offsets = tuple(int(field[1]) for field in fields)
        return dtype.names, inners, offsets, dtype.itemsize, dtype.isalignedstruct
    if not _LEAF.fullmatch(dtype.str):
        raise NumPyStateError(f"it holds the dtype {dtype}, which is none of numbers or text")
    return dtype.str


def array_of(
    dtype: Description, shape: tuple[int, ...], order: str, writeable: bool, content: bytes
) -> NDArray[Any]:
    """Make an array again."""
    array = _view(dtype, shape, order, content)
    return array.copy(order="K") if writeable else array


def scalar_of(dtype: Description, content: bytes) -> Any:
    """Make a scalar again."""
    return _view(dtype, (), "C", content)[()]


def dtype_of(description: Description) -> np.dtype[Any]:
    """Make a dtype of numbers, text or records of them again."""
    if isinstance(description, str) and _LEAF.fullmatch(description):
        return np.dtype(description)
    if isinstance(description, tuple) and len(description) == 2:
        inner, shape = description
        return np.dtype((dtype_of(inner), shape))
    if isinstance(description, tuple) and len(description) == 5:
        names, inners, offsets, itemsize, aligned = description
        fields = {
            "names": names,
            "formats": [dtype_of(inner) for inner in inners],
            "offsets": offsets,
            "itemsize": itemsize,
        }
        return np.dtype(fields, align=aligned)  # type: ignore[call-overload,no-any-return]
    shown = reprlib.repr(description)
    raise NumPyStateError(f"it holds the dtype {shown}, which is none of numbers or text")


def generator_of(bit_generator: Any) -> np.random.Generator:
    """Make a generator again."""
    return np.random.Generator(_checked(bit_generator, np.random.BitGenerator))


def bit_generator_of(name: str, state: Any, seed_seq: Any) -> np.random.BitGenerator:
    """Make a bit generator again, together with the seeds of those that it will spawn."""
    if name not in BIT_GENERATORS:
        raise NumPyStateError(f"it holds the bit generator {name!r}")
    made: np.random.BitGenerator = getattr(np.random, name)(
        _checked(seed_seq, np.random.SeedSequence)
    )
    made.state = state
    return made


def seed_sequence_of(
    entropy: Any, spawn_key: tuple[int, ...], pool_size: int, n_children_spawned: int
) -> np.random.SeedSequence:
    """Make a seed sequence again."""
    return np.random.SeedSequence(
        entropy,
        spawn_key=spawn_key,
        pool_size=pool_size,
        n_children_spawned=n_children_spawned,
    )


def _reduce_random(value: Any) -> Reduced | None:
    if type(value) is np.random.Generator:
        return generator_of, (value.bit_generator,)
    if isinstance(value, np.random.BitGenerator) and type(value).__name__ in BIT_GENERATORS:
        return bit_generator_of, (type(value).__name__, value.state, value.seed_seq)
    if type(value) is np.random.SeedSequence:
        seeds = (value.entropy, value.spawn_key, value.pool_size, value.n_children_spawned)
        return seed_sequence_of, seeds
    return None


def _reduce_array(array: NDArray[Any]) -> Reduced:
    # Sums depend on the order of the numbers in memory, in their last bit.
    order = "F" if array.flags.f_contiguous and not array.flags.c_contiguous else "C"
    content = _without_gaps(array).tobytes(order)  # type: ignore[arg-type]  # one of two letters
    return array_of, (
        describe(array.dtype),
        array.shape,
        order,
        array.flags.writeable,
        content,
    )


def _without_gaps(array: NDArray[Any]) -> NDArray[Any]:
    # What lies between the fields of a record is whatever was in memory before, and equal states
    # shall have equal bytes.
    if array.dtype.names is None:
        return array
    clean = np.zeros_like(array)
    _copy_fields(array, clean)
    return clean


def _copy_fields(source: NDArray[Any], target: NDArray[Any]) -> None:
    for name in source.dtype.names or ():
        if source[name].dtype.names is None:
            target[name][...] = source[name]
        else:
            _copy_fields(source[name], target[name])


def _view(dtype: Description, shape: tuple[int, ...], order: str, content: bytes) -> NDArray[Any]:
    return np.ndarray(
        shape,
        dtype_of(dtype),
        buffer=_checked(content, bytes),
        order=order,  # type: ignore[arg-type]  # NumPy checks the letter
    )


def _checked(value: Any, kind: type) -> Any:
    if not isinstance(value, kind):
        raise NumPyStateError(f"it holds {type(value).__name__} where {kind.__name__} belongs")
    return value
