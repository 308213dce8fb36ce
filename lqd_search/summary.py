"""The figures of a finished run, as `lqd show` prints them."""

from dataclasses import asdict
from typing import Any

from lqd_search.fitness_exploration import LanguageDrivenQD
from lqd_search.run_config import RunConfig
from lqd_search.success_archive import SuccessArchive
from lqd_search.tally import Tally


def summarize(
    *,
    config: RunConfig,
    method: LanguageDrivenQD,
    tally: Tally,
    successes: SuccessArchive,
    seconds: float,
) -> dict[str, Any]:
    """Return the figures of a run as plain numbers and strings.

    Args:
        config: What the run was asked to do.
        method: The method, done.
        tally: The run's counts.
        successes: What of its output the expert approves.
        seconds: How long the run took.

    Returns:
        The contents of `summary.json`; docs/run-folder.md describes its keys.
    """
    archive = method.archive
    return {
        "task": config.task,
        "method": config.method,
        "seed": config.seed,
        "sample": config.sample,
        "evaluations": tally.evaluations,
        "batch_size": config.batch_size,
        "rejected": tally.rejected,
        "discarded": tally.discarded,
        "valid": tally.valid,
        "inferred_successes": tally.inferred_successes,
        "expert_successes": tally.expert_successes,
        "confusion": {
            "both": tally.confusion[True][True],
            "inferred_only": tally.confusion[False][True],
            "expert_only": tally.confusion[True][False],
            "neither": tally.confusion[False][False],
        },
        "archive_size": successes.elites,
        "inferred_archive_size": successes.inferred,
        "success_archive_size": successes.size,
        "ground_truth_cells": len(successes.cells),
        "ground_truth_outside": successes.outside,
        "exploration": dict(method.exploration),
        "chosen_fitness": method.chosen,
        "grids": [
            {
                "name": name,
                "dims": list(archive.specs[name].dims),
                "ranges": [list(bounds) for bounds in archive.specs[name].ranges],
                "filled": len(grid),
                "successes": int(grid.data("success").sum()),
                "coverage": len(grid) / int(grid.cells),
                "clipped": archive.clipped[name],
            }
            for name, grid in archive.grids.items()
        ],
        "waiting_descriptors": [n for n in archive.descriptors if n not in archive.grids],
        "refused": [
            {"kind": kind, "functional": functional, "reason": reason, "count": count}
            for (kind, functional, reason), count in sorted(tally.refusals.items())
        ],
        "dropped": list(config.dropped),
        "model": config.model,
        "provenance": config.provenance,
        "seconds": seconds,
        "versions": asdict(config)["versions"],
    }
