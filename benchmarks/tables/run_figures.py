"""Reading a finished run folder as the figures of a cell."""

from math import prod
from pathlib import Path

from benchmarks.tables.cell import Cell
from benchmarks.tables.cell_figures import CellError, CellFigures, Curve, Verdicts
from lqd_search.runs.metrics_rows import read_metrics
from lqd_search.runs.run_folder import RunFolder
from lqd_search.runs.run_folder_error import RunFolderError
from lqd_search.runs.summary import Summary


def read_run(folder: Path, *, cell: Cell, steering: str, machine: str, commit: str) -> CellFigures:
    """Return the figures of a finished run.

    Args:
        folder: The run's folder.
        cell: Which cell it is said to be.
        steering: What steered it, a value of `STEERING`.
        machine: What it ran on.
        commit: Of the sources.

    Raises:
        LQDError: The run is not finished, damaged, or another one than the cell says.
    """
    run = RunFolder.open(folder)
    config, summary = run.config(), run.summary()
    found = (summary["task"], summary["method"], summary["seed"], summary["sample"])
    if found != (cell.task_id, cell.method, cell.seed, cell.sample):
        raise CellError(
            f"Expected the run of the cell {cell.name} in {folder}, but it is of "
            f"{', '.join(map(str, found))}; move it away, and the cell is run again."
        )
    outcomes, elites = summary["outcomes"], run.archive().fields
    return CellFigures(
        task=cell.task,
        method=cell.method,
        seed=cell.seed,
        sample=cell.sample,
        evaluations=summary["evaluations"],
        batch_size=summary["batch_size"],
        switches=config.switches,
        functionals=config.functionals,
        capacity=_capacity(summary),
        steering=steering,
        valid=summary["valid"],
        rejected=sum(summary["rejected"].values()),
        discarded=sum(summary["discarded"].values()),
        inferred_successes=summary["inferred_successes"],
        expert_successes=summary["expert_successes"],
        motions=Verdicts(**summary["confusion"]),
        elites=Verdicts.of(elites["success"], elites["expert"]),
        archive_size=summary["archive_size"],
        success_archive_size=summary["success_archive_size"],
        ground_truth_cells=summary["ground_truth_cells"],
        ground_truth_outside=summary["ground_truth_outside"],
        outcomes=outcomes["both"] + outcomes["expert_only"],
        outcome_cells=outcomes["ground_truth_cells"],
        outcomes_outside=outcomes["ground_truth_outside"],
        chosen_fitness=summary["chosen_fitness"],
        curve=read_curve(run.metrics.path, evaluations=summary["evaluations"]),
        seconds=summary["seconds"],
        model=summary["model"],
        provenance=summary["provenance"],
        machine=machine,
        commit=commit,
        versions=summary["versions"],
    )


def read_curve(path: Path, *, evaluations: int) -> Curve:
    """Return the curve that stands in a `metrics.csv`.

    Args:
        path: The file.
        evaluations: Evaluations of the run, with which it must end.

    Raises:
        CellError: It is missing, or is not one.
    """
    try:
        rows = read_metrics(path, evaluations=evaluations)
    except RunFolderError as error:
        raise CellError(
            f"Expected a row for each generation in {path}, but it cannot be read "
            f"({error.__cause__}); delete the run, and the cell is run again."
        ) from error
    return Curve(
        **{name: tuple(getattr(row, name) for row in rows) for name in Curve.__annotations__}
    )


def _capacity(summary: Summary) -> int:
    if summary["grids"]:
        return sum(prod(grid["dims"]) for grid in summary["grids"])
    # Without grids there is the population of `ga`, and all that `random` asked.
    return summary["batch_size"] if summary["method"] == "ga" else summary["evaluations"]
