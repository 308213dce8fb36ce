"""A small search problem that needs no simulator."""

from dataclasses import dataclass

import numpy as np
import pytest
from numpy.typing import NDArray

from lqd_search import Values
from lqd_search.runs.metrics import Metrics


@dataclass(frozen=True)
class ToyProblem:
    """Three numbers in [0, 1]; it is a solution space and its evaluator in one."""

    dim: int = 3
    rare_above: float = 0.97

    @property
    def descriptors(self) -> dict[str, int]:
        return {"start.place": 2, "start.flag": 2, "end.place": 3, "rare.place": 2}

    @property
    def fitness_names(self) -> tuple[str, ...]:
        return ("flat", "near", "away")

    def sample(self, n: int, *, rng: np.random.Generator) -> NDArray[np.float64]:
        return rng.random((n, self.dim))

    def mutate(
        self, parents: NDArray[np.float64], *, rng: np.random.Generator
    ) -> NDArray[np.float64]:
        return np.clip(parents + rng.normal(0.0, 0.1, parents.shape), 0.0, 1.0)

    def evaluate(self, solutions: NDArray[np.float64]) -> Values:
        x, y, z = solutions.T
        valid = z < 0.9
        distance = np.hypot(x - 0.8, y - 0.8)
        place = np.stack([x, y], axis=1)
        measures = {
            "start.place": place,
            "start.flag": np.stack([x, (y > 0.5).astype(float)], axis=1),
            "end.place": np.where((x > 0.2)[:, None], np.stack([x * y, z, x], axis=1), np.nan),
            "rare.place": np.where((x > self.rare_above)[:, None], place, np.nan),
        }
        invalid = ~valid
        for block in measures.values():
            block[invalid] = np.nan
        fitness = {"flat": np.zeros(len(x)), "near": -distance, "away": distance}
        return Values(
            valid=valid,
            success=valid & (distance < 0.12),
            fitness={name: np.where(valid, f, np.nan) for name, f in fitness.items()},
            measures=measures,
            passive={"expert": valid & (distance < 0.1)},
        )


@pytest.fixture(scope="session")
def make_metrics():
    def make(generation=1, **changes) -> Metrics:
        figures = {
            "generation": generation,
            "stage": "first batch",
            "evaluations": 32 * generation,
            "valid": 10,
            "rejected": 20,
            "discarded": 2,
            "refused": 0,
            "inferred_successes": 1,
            "expert_successes": 2,
            "archive_size": 10,
            "inferred_archive_size": 1,
            "success_archive_size": 2,
            "ground_truth_cells": 2,
            "coverage": 0.25,
            "clipped": 0,
            "outcomes": 3,
            "outcome_cells": 2,
            "seconds": 1.5,
        }
        return Metrics(**figures | changes)

    return make


@pytest.fixture(scope="session")
def toy() -> ToyProblem:
    return ToyProblem()
