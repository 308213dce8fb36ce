"""The figures of a finished run, as `lqd show` prints them."""

from typing import TypedDict

from lqd_search.archives.multi_bd_archive import MultiBDArchive
from lqd_search.runs.outcome_archive import OutcomeFigures
from lqd_search.runs.run_config import RunConfig
from lqd_search.runs.run_state import RunState
from lqd_search.runs.success_archive import SuccessArchive
from lqd_search.runs.tally import Tally


class Confusion(TypedDict):
    """Valid motions by the conditions that approved them."""

    both: int
    inferred_only: int
    expert_only: int
    neither: int


class Outcomes(TypedDict):
    """Distinct successes of the whole run."""

    both: int
    inferred_only: int
    expert_only: int
    ground_truth_cells: int
    ground_truth_outside: int


class GridFigures(TypedDict):
    """The figures of one grid."""

    name: str
    dims: list[int]
    ranges: list[list[float]]
    filled: int
    successes: int
    coverage: float
    clipped: int


class RefusalFigures(TypedDict):
    """How often a functional's value was refused for one reason."""

    kind: str
    functional: str
    reason: str
    count: int


class Summary(TypedDict):
    """The contents of `summary.json`; docs/run-folder.md describes its keys."""

    task: str
    method: str
    seed: int
    sample: int
    evaluations: int
    batch_size: int
    failure_competition: str
    rejected: dict[str, int]
    discarded: dict[str, int]
    valid: int
    inferred_successes: int
    expert_successes: int
    confusion: Confusion
    archive_size: int
    inferred_archive_size: int
    success_archive_size: int
    ground_truth_cells: int
    ground_truth_outside: int
    outcomes: Outcomes
    exploration: dict[str, int]
    chosen_fitness: str | None
    grids: list[GridFigures]
    waiting_descriptors: list[str]
    same_descriptors: list[list[str]]
    degenerate_descriptors: list[str]
    undefined_descriptors: list[str]
    refused: list[RefusalFigures]
    stopped: list[str]
    dropped: list[str]
    repaired: list[str]
    remarks: list[str]
    llm: str
    model: str
    provenance: str
    usage: str
    seconds: float
    versions: dict[str, str]


def summarize(
    *, config: RunConfig, state: RunState, successes: SuccessArchive, outcomes: OutcomeFigures
) -> Summary:
    """Return the figures of a run as plain numbers and strings.

    Args:
        config: What the run was asked to do.
        state: Where it ended.
        successes: What of its output the expert approves.
        outcomes: How many distinct successes it found.
    """
    archive, tally, report = state.method.archive, state.tally, state.report
    return {
        "task": config.task,
        "method": config.method,
        "seed": config.seed,
        "sample": config.sample,
        "evaluations": tally.evaluations,
        "batch_size": config.batch_size,
        "failure_competition": config.failure_competition,
        "rejected": tally.rejected,
        "discarded": tally.discarded,
        "valid": tally.valid,
        "inferred_successes": tally.inferred_successes,
        "expert_successes": tally.expert_successes,
        "confusion": _confusion(tally),
        "archive_size": successes.elites,
        "inferred_archive_size": successes.inferred,
        "success_archive_size": successes.size,
        "ground_truth_cells": len(successes.cells),
        "ground_truth_outside": successes.outside,
        "outcomes": _outcomes(outcomes),
        "exploration": dict(state.method.exploration),
        "chosen_fitness": state.method.chosen,
        "grids": [] if archive is None else [_grid(archive, name) for name in archive.specs],
        "waiting_descriptors": [] if archive is None else _waiting(archive),
        "same_descriptors": [list(group) for group in report.same] if report else [],
        "degenerate_descriptors": list(report.degenerate) if report else [],
        "undefined_descriptors": list(report.undefined) if report else [],
        "refused": _refused(tally),
        "stopped": list(map(str, state.stopped)),
        "dropped": list(config.dropped),
        "repaired": list(config.repaired),
        "remarks": list(config.remarks),
        "llm": config.llm,
        "model": config.model,
        "provenance": config.provenance,
        "usage": config.usage_in_words,
        "seconds": state.seconds,
        "versions": dict(config.versions),
    }


def _confusion(tally: Tally) -> Confusion:
    return {
        "both": tally.confusion[True][True],
        "inferred_only": tally.confusion[False][True],
        "expert_only": tally.confusion[True][False],
        "neither": tally.confusion[False][False],
    }


def _outcomes(figures: OutcomeFigures) -> Outcomes:
    return {
        "both": figures.both,
        "inferred_only": figures.success_only,
        "expert_only": figures.expert_only,
        "ground_truth_cells": figures.cells,
        "ground_truth_outside": figures.outside,
    }


def _waiting(archive: MultiBDArchive) -> list[str]:
    return [name for name in archive.descriptors if name not in archive.specs]


def _grid(archive: MultiBDArchive, name: str) -> GridFigures:
    spec, filled = archive.specs[name], archive.filled[name]
    shape = spec.to_dict()
    return {
        "name": name,
        "dims": shape["dims"],
        "ranges": shape["ranges"],
        "filled": filled,
        "successes": archive.successes[name],
        "coverage": filled / spec.cells,
        "clipped": archive.clipped[name],
    }


def _refused(tally: Tally) -> list[RefusalFigures]:
    return [
        {"kind": kind, "functional": functional, "reason": reason, "count": count}
        for (kind, functional, reason), count in sorted(tally.refusals.items())
    ]
