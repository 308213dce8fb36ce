"""Made-up cells, and a small study that they belong to."""

import pytest

from benchmarks.tables.cell import Cell
from benchmarks.tables.cell_figures import CellFigures, Curve, Verdicts
from benchmarks.tables.study import Study, compare_with_first
from lqd_search.methods.by_name import KEPT_SWITCHES


@pytest.fixture(scope="session")
def make_figures():
    def make(cell: Cell, **changes) -> CellFigures:
        figures = {
            "task": cell.task,
            "method": cell.method,
            "seed": cell.seed,
            "sample": cell.sample,
            "evaluations": 320,
            "batch_size": 8,
            "switches": tuple(sorted(KEPT_SWITCHES)) if cell.method == "ours_plus" else (),
            "functionals": "" if cell.method == "handcrafted" else f"digest {cell.sample}",
            "capacity": 100 if cell.method == "handcrafted" else 160_000,
            "steering": "expert" if cell.method == "handcrafted" else "mesh",
            "valid": 110,
            "rejected": 200,
            "discarded": 10,
            "inferred_successes": 12,
            "expert_successes": 16,
            "motions": Verdicts(both=9, inferred_only=3, expert_only=7, neither=91),
            "elites": Verdicts(both=6, inferred_only=2, expert_only=0, neither=40),
            "archive_size": 48,
            "success_archive_size": 6,
            "ground_truth_cells": 5,
            "ground_truth_outside": 1,
            "outcomes": 16,
            "outcome_cells": 11,
            "outcomes_outside": 2,
            "chosen_fitness": None,
            "curve": Curve((160, 320), (2, 6), (2, 5), (7, 16), (6, 11)),
            "seconds": 1800.0,
            "model": "a model",
            "provenance": "Made up for a test.",
            "machine": "a machine",
            "commit": "0123456789ab",
            "versions": {"python": "3.11.0", "numpy": "2.0"},
        }
        return CellFigures(**figures | changes)

    return make


@pytest.fixture(scope="session")
def study() -> Study:
    """Return two methods on two tasks with three seeds."""
    tasks, methods, seeds = ("faucet", "drawer"), ("ours", "handcrafted"), (0, 1, 2)
    return Study(
        title="A small study",
        scale="smoke",
        evaluations=320,
        batch_size=8,
        tasks=tasks,
        methods=methods,
        seeds=seeds,
        cells=tuple(Cell.of(t, m, s) for s in seeds for t in tasks for m in methods),
        family=compare_with_first(tasks, methods),
    )
