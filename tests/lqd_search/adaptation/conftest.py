"""A small made-up archive."""

import numpy as np
import pytest

from lqd_envs import SolutionSpace
from lqd_search.archives.grid_spec import GridSpec
from lqd_search.runs.stored_archive import StoredArchive, StoredGrid


@pytest.fixture
def make_archive():
    """Return a way to make an archive, of which columns can be given."""

    def make(n=6, *, grids=None, **columns) -> StoredArchive:
        fields = {
            "solution": SolutionSpace().sample(n, rng=np.random.default_rng(0)),
            "objective": np.linspace(0.0, 1.0, n),
            "success": np.ones(n, bool),
            "evaluation": np.arange(n),
            "expert": np.ones(n, bool),
            "ground_truth": np.zeros((n, 1)),
            "digest": np.arange(n, dtype=np.uint64),
        }
        return StoredArchive(fields | columns, grids or {})

    return make


@pytest.fixture
def make_grid():
    """Return a way to make a grid of one measure from 0 to 10."""

    def make(elites, measures) -> StoredGrid:
        return StoredGrid(
            spec=GridSpec(dims=(10,), ranges=((0.0, 10.0),)),
            cells=np.arange(len(elites)),
            elites=np.array(elites),
            measures=np.array(measures, float)[:, None],
        )

    return make
