"""The figures of one generation: a row of `metrics.csv`."""

from dataclasses import dataclass

from lqd_search.archives.multi_bd_archive import MultiBDArchive
from lqd_search.runs.outcome_archive import OutcomeFigures
from lqd_search.runs.success_archive import SuccessArchive
from lqd_search.runs.tally import Tally


@dataclass(frozen=True)
class Metrics:
    """Where a run stands after a generation.

    The counts run over the whole run. The archive's figures are those of what the method would put
    out now; for `ours` that is the archive that is being filled, which starts anew with each short
    run of the fitness exploration.

    Attributes:
        generation: Number of the generation, from 1.
        stage: What the method was doing.
        evaluations: Evaluations so far.
        valid: Motions so far that were judged.
        rejected: Motions so far that failed before simulation.
        discarded: Motions so far that failed in simulation.
        refused: Values of functionals so far that were refused.
        inferred_successes: Motions so far that the inferred condition approved.
        expert_successes: Motions so far that the expert's condition approved.
        archive_size: Distinct elites in the archive.
        inferred_archive_size: Those of them that the inferred condition approves.
        success_archive_size: Those of them that the expert's condition approves.
        ground_truth_cells: Cells of the ground-truth grid that these fill.
        coverage: Share of cells that are filled, mean over the grids; None: the method has none.
        clipped: Solutions that were offered to a present grid with a measure out of its range,
            summed over the grids.
        outcomes: Distinct successes of the whole run, by the expert's condition.
        outcome_cells: Cells of the ground-truth grid that these fill.
        seconds: Time since the run began, in s.
    """

    generation: int
    stage: str
    evaluations: int
    valid: int
    rejected: int
    discarded: int
    refused: int
    inferred_successes: int
    expert_successes: int
    archive_size: int
    inferred_archive_size: int
    success_archive_size: int
    ground_truth_cells: int
    coverage: float | None
    clipped: int
    outcomes: int
    outcome_cells: int
    seconds: float


def measure_generation(
    *,
    generation: int,
    stage: str,
    tally: Tally,
    archive: MultiBDArchive | None,
    successes: SuccessArchive,
    outcomes: OutcomeFigures,
    seconds: float,
) -> Metrics:
    """Return the figures of a run after a generation.

    Args:
        generation: Number of the generation, from 1.
        stage: What the method was doing.
        tally: The run's counts.
        archive: The archive that is being filled; None: the method has none.
        successes: What of its output the expert approves.
        outcomes: How many distinct successes the run has found.
        seconds: Time since the run began.
    """
    return Metrics(
        generation=generation,
        stage=stage,
        evaluations=tally.evaluations,
        valid=tally.valid,
        rejected=sum(tally.rejected.values()),
        discarded=sum(tally.discarded.values()),
        refused=tally.refused,
        inferred_successes=tally.inferred_successes,
        expert_successes=tally.expert_successes,
        archive_size=successes.elites,
        inferred_archive_size=successes.inferred,
        success_archive_size=successes.size,
        ground_truth_cells=len(successes.cells),
        coverage=None if archive is None else mean_coverage(archive),
        clipped=0 if archive is None else sum(archive.clipped.values()),
        outcomes=outcomes.expert,
        outcome_cells=outcomes.cells,
        seconds=seconds,
    )


def mean_coverage(archive: MultiBDArchive) -> float:
    """Return the share of filled cells, mean over the grids; 0 before there is one."""
    filled = archive.filled
    shares = [filled[name] / spec.cells for name, spec in archive.specs.items()]
    return sum(shares) / len(shares) if shares else 0.0
