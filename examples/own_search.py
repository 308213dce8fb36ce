"""A search of one's own in ten lines: no simulator, no command line, no task of ours."""

import numpy as np

from lqd_search import BoxSpace, MapElitesSuccess, Values, search


def throw(x: np.ndarray) -> Values:
    """Throw balls with the velocities (n, 2) x, in m/s: how far they come, and how high."""
    time = 2.0 * x[:, 1] / 9.81
    place = np.stack([x[:, 0] * time, x[:, 1] ** 2 / 19.62], axis=1)
    effort = np.stack([np.hypot(*x.T), np.arctan2(x[:, 1], x[:, 0])], axis=1)
    hit = np.abs(place[:, 0] - 5.0) < 0.5
    energy = {"thrift": -(effort[:, 0] ** 2)}
    return Values(np.ones(len(x), bool), hit, energy, {"flight": place, "throw": effort})


space = BoxSpace([0.0, 0.0], [15.0, 15.0])
method = MapElitesSuccess(
    space,
    descriptors={"flight": 2, "throw": 2},
    fitness="thrift",
    evaluations=20_000,
    batch_size=500,
    rng=np.random.default_rng(0),
)
search(method, throw)
elites = method.archive.elites()
print(f"{len(elites)} throws, {elites.successes} of them hit")  # noqa: T201
