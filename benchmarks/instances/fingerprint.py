"""A fingerprint of all that shapes a judgement beside the archive and the instance."""

import json
from hashlib import blake2b

import numpy as np

from benchmarks.instances.candidates import Candidates, candidates_of
from benchmarks.instances.declared import FILTERS, RULES, SIZES, SUBSETS, TRIES
from lqd_envs import SolutionSpace
from lqd_search.adaptation import SELECTORS
from lqd_search.archives.grid_spec import GridSpec
from lqd_search.runs.stored_archive import StoredArchive, StoredGrid

_ELITES = 64


def fingerprint(cap: int) -> str:
    """Return a fingerprint of what is declared and of how motions are drawn and chosen.

    It has the number of the rules, the sizes, the number of subsets, the tries, the filters, the
    selectors and the cap in it, and what is drawn and chosen from a small made-up archive: where a
    selector chooses otherwise than it did, the fingerprint is another one.

    Args:
        cap: Most motions of an archive that are drawn for simulation.
    """
    found = candidates_of(_archive(), cap=cap, seed=0)
    declared = {
        "cap": cap,
        "rules": RULES,
        "sizes": SIZES,
        "subsets": SUBSETS,
        "tries": TRIES,
        "filters": list(FILTERS),
        "selectors": list(SELECTORS),
        "candidates": {name: _plain(candidates) for name, candidates in found.items()},
    }
    return blake2b(json.dumps(declared).encode(), digest_size=8).hexdigest()


def _archive() -> StoredArchive:
    rng = np.random.default_rng(0)
    held = np.arange(0, _ELITES, 2)
    grid = StoredGrid(
        spec=GridSpec(dims=(_ELITES,), ranges=((0.0, 1.0),)),
        cells=held,
        elites=held,
        measures=rng.random((len(held), 1)),
    )
    return StoredArchive(
        {
            "solution": SolutionSpace().sample(_ELITES, rng=rng),
            "objective": rng.random(_ELITES),
            "success": rng.random(_ELITES) < 0.8,
            "evaluation": np.arange(_ELITES),
            "expert": rng.random(_ELITES) < 0.8,
            "ground_truth": rng.random((_ELITES, 1)),
            "digest": np.arange(_ELITES, dtype=np.uint64),
        },
        {"a grid": grid},
    )


def _plain(candidates: Candidates) -> list[object]:
    return [
        candidates.rows.tolist(),
        candidates.sample.tolist(),
        {name: rows.tolist() for name, rows in candidates.picks.items()},
        {
            name: {size: rows.tolist() for size, rows in by_size.items()}
            for name, by_size in candidates.subset_picks.items()
        },
    ]
