"""Small archives and batches for emitters."""

import numpy as np
import pytest

from lqd_search import GridSpec, MultiBDArchive, Values
from lqd_search.emitters.emitter import Evaluated


def archive_of(places, *, success, solutions=None, **extra):
    """An archive with a grid of ten cells over [0, 10] for each descriptor.

    `places` has a list for each descriptor, with a place or None for each solution; the solutions
    are numbered from 0 unless they are given.
    """
    n = len(success)
    if solutions is None:
        solutions = np.arange(n, dtype=float)[:, None]
    archive = MultiBDArchive(
        descriptors=dict.fromkeys(places, 1),
        solution_dim=solutions.shape[1],
        extra_fields={name: (column.shape[1:], column.dtype) for name, column in extra.items()},
    )
    for name in places:
        archive.set_grid(name, GridSpec(dims=(10,), ranges=((0.0, 10.0),)))
    rows = [[np.nan if p is None else p for p in of_grid] for of_grid in places.values()]
    archive.add(
        solution=solutions,
        objective=np.zeros(n),
        measures=np.array(rows, float).T.reshape(n, len(places)),
        success=np.array(success, bool),
        **extra,
    )
    return archive


def batch_of(solutions, *, asked=True, success=None, status=None, value=None, **columns):
    """What became of some solutions."""
    n = len(solutions)
    columns = {"measures": {"a": np.zeros((n, 1))}, "valid": np.ones(n, bool)} | columns
    return Evaluated(
        solutions=solutions,
        values=Values(
            success=np.zeros(n, bool) if success is None else np.array(success, bool),
            fitness={"f": np.zeros(n)},
            **columns,
        ),
        objective=np.zeros(n),
        status=np.full(n, 1, np.int32) if status is None else np.array(status, np.int32),
        value=np.zeros(n) if value is None else np.array(value, float),
        asked=asked,
    )


@pytest.fixture(scope="session", name="archive_of")
def _archive_of():
    return archive_of


@pytest.fixture(scope="session", name="batch_of")
def _batch_of():
    return batch_of
