"""One run of `ours` with some switches."""

import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.recorded_recipe import recorded_recipe
from benchmarks.tables.cell import Cell
from benchmarks.tables.machine import describe_commit
from lqd_envs import get_task
from lqd_search.loop import search
from lqd_search.methods.by_name import Setting, ours_with
from lqd_search.methods.plus_switches import Switch
from lqd_search.runs.success_archive import SuccessArchive

OURS = "ours"
"""What stands for a run without any switch."""


@dataclass(frozen=True)
class SwitchCell:
    """One run of `ours` with some switches.

    Attributes:
        task: Short name of the task.
        switches: Names of the switches that are on, joined by `+`; `ours` for none.
        seed: Seed of the search.
        evaluations: Evaluations spent.
        batch_size: Solutions in a generation.
        success_archive_size: Elites that the expert's condition approves.
        ground_truth_cells: Cells of the ground-truth grid that these fill.
        archive_size: Distinct elites.
        valid: Motions that were judged.
        seconds: How long it took.
        commit: Of the sources; empty where it is not known.
    """

    task: str
    switches: str
    seed: int
    evaluations: int
    batch_size: int
    success_archive_size: int
    ground_truth_cells: int
    archive_size: int
    valid: int
    seconds: float
    commit: str = ""

    @property
    def found(self) -> tuple[int, ...]:
        """All that it found, by which it shows whether a switch did anything."""
        return (self.success_archive_size, self.ground_truth_cells, self.archive_size, self.valid)


def run_cell(
    task_name: str, switches: Sequence[Switch], *, seed: int, evaluations: int, batch_size: int
) -> SwitchCell:
    """Run `ours` with some switches on, and judge its archive."""
    cell = Cell.of(task_name, "ours_plus", seed)
    task = get_task(cell.task_id)
    recipe = recorded_recipe(task, method=cell.method, sample=cell.sample, threads=1)
    valid: list[int] = []
    began = time.monotonic()
    with recipe.opened() as evaluate:
        setting = Setting(
            task=task,
            judge=evaluate.judge,
            evaluations=evaluations,
            batch_size=batch_size,
            rng=np.random.default_rng(seed),
        )
        method = ours_with(setting, switches=switches)
        search(method, evaluate, observe=lambda told: valid.append(int(told.values.valid.sum())))
    archive = SuccessArchive.of(method.output(), ground_truth=task.ground_truth)
    return SwitchCell(
        task=task_name,
        switches="+".join(switches) or OURS,
        seed=seed,
        evaluations=evaluations,
        batch_size=batch_size,
        success_archive_size=archive.size,
        ground_truth_cells=len(archive.cells),
        archive_size=archive.elites,
        valid=sum(valid),
        seconds=time.monotonic() - began,
        commit=describe_commit(),
    )
