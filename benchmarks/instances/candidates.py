"""Which motions of an archive are looked at: all, a sample, and what selectors choose."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from benchmarks.instances.declared import FILTERS, SIZES, SUBSETS, TRIES
from lqd_search.adaptation import SELECTORS, ArchiveView
from lqd_search.runs.stored_archive import StoredArchive

_MOST_TRIES = max(TRIES)
Rows = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Candidates:
    """The motions of an archive that one condition approves.

    Attributes:
        rows: (n,) elites of the archive.
        sample: (m,) some of them, drawn at random; in random order.
        picks: For each selector, the first that it tries of all n.
        subset_picks: For each selector and each size below m, (`SUBSETS`, t) the first that it
            tries of random subsets of the sample.
    """

    rows: Rows
    sample: Rows
    picks: Mapping[str, Rows]
    subset_picks: Mapping[str, Mapping[int, Rows]]

    @property
    def simulated(self) -> Rows:
        """Those that are simulated in an instance with dynamics of its own, ascending."""
        return self.with_picks(self.sample)

    def with_picks(self, judged: Rows) -> Rows:
        """Return these and what selectors choose beside them, ascending."""
        return np.unique(np.concatenate([judged, *self.picks.values()]))


def most_looked_at(cap: int) -> int:
    """Return the most motions that are looked at where not all are: drawn and chosen ones.

    Args:
        cap: Most motions in a sample.
    """
    return cap + _MOST_TRIES * len(SELECTORS)


def candidates_of(archive: StoredArchive, *, cap: int, seed: int) -> Mapping[str, Candidates]:
    """Return the candidates by filter.

    Filters share the draw, so that their samples have in common what they can. A subset of the
    sample is a random subset of the archive as well.

    Args:
        archive: The archive.
        cap: Most motions in a sample.
        seed: Seed of the draws.
    """
    order = np.random.default_rng([seed, 0]).permutation(len(archive))
    view = ArchiveView.of(archive)
    found = {}
    for name, approved in FILTERS.items():
        kept = approved(archive)
        found[name] = _candidates(
            view,
            rows=np.flatnonzero(kept),
            sample=order[kept[order]][:cap],
            rng=np.random.default_rng([seed, 1]),
        )
    return found


def _candidates(
    view: ArchiveView, *, rows: Rows, sample: Rows, rng: np.random.Generator
) -> Candidates:
    picks = {name: _pick(view, rows, name) for name in SELECTORS}
    subset_picks: dict[str, dict[int, Rows]] = {name: {} for name in SELECTORS}
    # Subsets of one draw lie in one another, as an archive grows.
    draws = [rng.permutation(sample) for _ in range(SUBSETS)]
    for size in SIZES:
        if size < len(sample):
            for name, by_size in subset_picks.items():
                by_size[size] = np.stack(
                    [_pick(view, np.sort(draw[:size]), name) for draw in draws]
                )
    return Candidates(rows, sample, picks, subset_picks)


def _pick(view: ArchiveView, rows: Rows, selector: str) -> Rows:
    return rows[SELECTORS[selector].select(view.rows(rows), _MOST_TRIES)]
