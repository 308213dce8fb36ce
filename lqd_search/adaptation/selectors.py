"""In which order to try the motions of an archive."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from lqd_envs import SolutionSpace
from lqd_search.adaptation.archive_view import ArchiveView
from lqd_search.archives.worth import worth_of

Selector: TypeAlias = Callable[[ArchiveView, int], NDArray[np.intp]]
"""Returns which rows of a view to try, the first one first: as many distinct ones as the number
says, or all where there are fewer. It knows nothing of the instance."""


@dataclass(frozen=True)
class NamedSelector:
    """A selector and what it is called.

    Attributes:
        name: Its name.
        summary: What it does, in a few words.
        select: The selector.
    """

    name: str
    summary: str
    select: Selector


def best_first(view: ArchiveView, count: int) -> NDArray[np.intp]:
    """Return the rows of the highest objectives, the highest first.

    Of equal objectives the one of the lower row is first; those without an objective are last.

    Args:
        view: What may be seen of the archive.
        count: How many rows, at most.
    """
    return np.argsort(-worth_of(view.objective), kind="stable")[:count]


def farthest_first(view: ArchiveView, count: int) -> NDArray[np.intp]:
    """Return rows that are spread out: each is the one farthest from all before it.

    The first one has the highest objective, and of equally far ones the one of the higher objective
    is taken. The squared distance of two motions is the mean squared difference of their solutions,
    in shares of the space's widths and the shorter way round in yaw. Where both hold cells of the
    same grids, it is the mean of that and of the mean squared difference of their measures there,
    in shares of the grids' ranges.

    Args:
        view: What may be seen of the archive.
        count: How many rows, at most.
    """
    order = best_first(view, len(view))
    ranked = view.rows(order)
    measures = np.concatenate([np.empty((len(view), 0)), *ranked.measures.values()], axis=1)
    chosen: list[int] = []
    nearest = np.full(len(view), np.inf)
    for _ in range(min(count, len(view))):
        row = int(np.argmax(nearest))
        chosen.append(row)
        nearest = np.minimum(nearest, _distances(ranked.solution, measures, row))
        # Below the distance of equal motions, so that none is chosen twice.
        nearest[row] = -1.0
    return order[chosen]


def _distances(
    solution: NDArray[np.float64], measures: NDArray[np.float64], row: int
) -> NDArray[np.float64]:
    """Return (n,) the squared distance of each row from one of them."""
    space = SolutionSpace()
    way = space.difference(solution, np.broadcast_to(solution[row], solution.shape))
    apart = np.mean((way / (space.upper - space.lower)) ** 2, axis=1)
    squares = (measures - measures[row]) ** 2
    both = ~np.isnan(squares)
    shared = both.sum(axis=1)
    mean = np.where(both, squares, 0.0).sum(axis=1) / np.maximum(shared, 1)
    return np.asarray(np.where(shared > 0, (apart + mean) / 2.0, apart))


SELECTORS: Mapping[str, NamedSelector] = MappingProxyType(
    {
        selector.name: selector
        for selector in (
            NamedSelector("best", "the highest objective first", best_first),
            NamedSelector("diverse", "each the farthest from those before it", farthest_first),
        )
    }
)
"""The selectors by name."""
