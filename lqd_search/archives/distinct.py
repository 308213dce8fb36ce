"""Which rows are the same: by their ids, by a hash, and in the end by comparing them."""

import numpy as np
from numpy.typing import NDArray

# Odd, so that multiplying by them loses nothing; otherwise any numbers.
_FACTOR = np.uint64(0x9E3779B97F4A7C15)
_LARGEST_TABLE = 16
"""Entries of a table of ids, per row."""


def first_of_each(ids: NDArray[np.generic]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Find the distinct ids of rows.

    Args:
        ids: (n,) ids, in any order.

    Returns:
        For each distinct id, in ascending order, the index of the first row that has it; and for
        each row the place of its id among them.
    """
    n = len(ids)
    countable = n > 0 and ids.dtype.kind in "iu"
    low, high = (int(ids.min()), int(ids.max())) if countable else (0, 0)
    if not countable or high - low > _LARGEST_TABLE * n:
        _, first, place = np.unique(ids, return_index=True, return_inverse=True)
        return first, place
    # The ids of a run are dense, and a table of them is faster than sorting.
    # Modulo 2**64 the difference is right for every integer type.
    offset = (ids.astype(np.uint64) - np.uint64(low % 2**64)).astype(np.intp)
    table = np.full(high - low + 1, -1, np.intp)
    # Of several assignments to an entry the last one stays, here that of the first row.
    table[offset[::-1]] = np.arange(n - 1, -1, -1)
    there = np.flatnonzero(table >= 0)
    first = table.take(there)
    table[there] = np.arange(len(there))
    return first, table.take(offset)


def first_of_equal(rows: NDArray[np.float64]) -> NDArray[np.intp]:
    """Find for each row the first one that equals it, which may be itself.

    Args:
        rows: (n, d) finite. The two zeros are equal.

    Returns:
        (n,) indices of rows.
    """
    hashes = hash_rows(rows)
    order = np.argsort(hashes, kind="stable")
    ordered = hashes.take(order)
    starts = np.ones(len(rows), bool)
    starts[1:] = ordered[1:] != ordered[:-1]
    first = np.empty(len(rows), np.intp)
    first[order] = order[starts].take(np.cumsum(starts) - 1)
    followers = np.flatnonzero(first != np.arange(len(rows)))
    unequal = followers[(rows[followers] != rows[first[followers]]).any(axis=1)]
    if len(unequal):
        # Different rows with the same hash: these few are sorted as a whole.
        suspects = np.flatnonzero(np.isin(hashes, hashes[unequal]))
        _, index, group = np.unique(rows[suspects], axis=0, return_index=True, return_inverse=True)
        first[suspects] = suspects[index[group]]
    return first


def hash_rows(rows: NDArray[np.float64]) -> NDArray[np.uint64]:
    """Hash rows, such that equal ones have the same hash and others hardly ever.

    Args:
        rows: (n, d) finite. The two zeros are equal.

    Returns:
        (n,) hashes.
    """
    # Adding 0 turns the negative zero into the positive one.
    bits = (np.ascontiguousarray(rows.T) + 0.0).view(np.uint64)
    hashes = np.zeros(len(rows), np.uint64)
    for column in bits:
        hashes ^= column
        hashes *= _FACTOR
        hashes ^= hashes >> np.uint64(32)
    return hashes
