"""Small run folders, with archives of motions that turn on the hot water."""

import numpy as np
import pytest

from benchmarks.instances import report
from lqd_envs import get_task, rollout

FAUCET = "LQD/Faucet-v0"
# Each is a success in the task itself, but for the last one, which stays in the air.
SOLUTIONS = np.array(
    [
        (0.19, 0.47, -0.17, -0.73, 0.88, -2.01, 0.4, -0.1, 0.32),
        (0.09, -0.58, -0.13, -1.05, -0.42, -0.56, -0.44, 0.54, 0.16),
        (-0.15, 0.86, -0.01, 0.69, 0.44, 3.02, -0.5, 0.79, 0.34),
        (0.29, 0.75, -0.75, -0.28, 0.23, 0.34, -0.37, -0.31, 0.04),
        (0.7, 0.54, -0.49, -0.14, 0.37, 0.86, -0.5, 0.2, 0.28),
        (0.68, 0.77, -0.61, -1.16, 1.16, 0.12, -0.33, -0.65, 0.25),
        (0.04, 0.94, -0.13, -0.74, 0.96, 1.61, -0.48, -0.39, 0.1),
        (0.0, 0.0, 0.9, 0.0, 0.0, 0.0, 0.0, 0.0, 0.5),
    ]
)


@pytest.fixture(scope="session")
def fields():
    """Return the columns of an archive of these motions, in the order of their fitness."""
    motions = rollout(get_task(FAUCET), SOLUTIONS, threads=1)
    n = len(SOLUTIONS)
    return {
        "solution": SOLUTIONS,
        "objective": -np.arange(n, dtype=float),
        # The first one is a success that the inferred condition misses, the last one none.
        "success": np.arange(n) > 0,
        "evaluation": np.arange(n),
        "expert": motions.success(),
        "ground_truth": motions.ground_truth(),
        "digest": motions.digests(),
    }


@pytest.fixture
def drawn(monkeypatch):
    """Draw no picture, which takes seconds, and say which would have been drawn."""
    names = []
    monkeypatch.setattr(report, "figure_files", lambda name, _: names.append(name) or {})
    return names


@pytest.fixture
def make_run(make_folder, fields):
    """Return a way to make the folder of a finished run whose archive has some of the motions."""

    def make(name="one", *, rows=slice(None), method="ours", seed=0, settings=None, **columns):
        chosen = {key: column[rows] for key, column in (fields | columns).items()}
        return make_folder(name, chosen, task=FAUCET, method=method, seed=seed, **(settings or {}))

    return make
