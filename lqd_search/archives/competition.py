"""The rule by which solutions compete for a cell: MAP-Elites Success."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class Candidates:
    """Solutions that want into the cells of one grid, in the order in which they came.

    Attributes:
        cell: (N,) integers, the cell each one falls into.
        success: (N,) bool.
        objective: (N,) float64, finite.
    """

    cell: NDArray[np.integer]
    success: NDArray[np.bool_]
    objective: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Incumbents:
    """The elites that the candidates meet: row i is about the cell of candidate i.

    Attributes:
        occupied: (N,) bool, whether there is an elite at all; the other columns mean nothing
            where there is none.
        success: (N,) bool.
        objective: (N,) float64.
    """

    occupied: NDArray[np.bool_]
    success: NDArray[np.bool_]
    objective: NDArray[np.float64]


Competition = Callable[[Candidates, Incumbents], NDArray[np.intp]]
"""Decides who is inserted: ascending indices of the winning candidates, at most one per cell.

The outcome is that of inserting the candidates one by one in their order.
"""


def compete_by_fitness(candidates: Candidates, incumbents: Incumbents) -> NDArray[np.intp]:
    """Let a success beat a failure, and otherwise the strictly higher objective win.

    This is the competition of the paper's MAP-Elites Success. An empty cell takes whatever comes. A
    tie keeps the elite that is there.

    Args:
        candidates: Those who want in.
        incumbents: The elites of their cells.

    Returns:
        Ascending indices of the winners, at most one per cell.
    """
    return _winners(candidates, incumbents)


def compete_by_coin(rng: np.random.Generator) -> Competition:
    """Make the rule of Huber's ME-scs: as by fitness, but two failures toss a fair coin.

    Args:
        rng: Tosses one coin per candidate and call, in the candidates' order and whether it is
            needed or not; `rng.random() < 0.5` lets the newcomer win. An archive draws from a copy.

    Returns:
        The competition; it can be pickled, together with its generator's state.
    """
    return _CoinCompetition(rng)


@dataclass(frozen=True, eq=False)
class _CoinCompetition:
    rng: np.random.Generator

    def __call__(self, candidates: Candidates, incumbents: Incumbents) -> NDArray[np.intp]:
        tossed = self.rng.random(len(candidates.cell)) < 0.5
        # Of several failures in a cell the last lucky one stays, and any of them loses against an
        # incumbent unless it is lucky: their rank in time is an objective that says just that.
        rank = np.where(tossed, np.arange(len(tossed), dtype=np.float64), -1.0)
        return _winners(
            Candidates(
                candidates.cell,
                candidates.success,
                np.where(candidates.success, candidates.objective, rank),
            ),
            Incumbents(
                incumbents.occupied,
                incumbents.success,
                np.where(incumbents.success, incumbents.objective, -1.0),
            ),
        )


def _winners(candidates: Candidates, incumbents: Incumbents) -> NDArray[np.intp]:
    success, objective = candidates.success, candidates.objective
    better = (success & ~incumbents.success) | (
        (success == incumbents.success) & (objective > incumbents.objective)
    )
    # Whoever does not beat the elite that was there before the batch cannot win the cell, and late
    # in a run that is nearly everybody.
    rivals = np.flatnonzero(better | ~incumbents.occupied)
    cell, success = candidates.cell.take(rivals), success.take(rivals)
    cells = int(cell.max(initial=-1)) + 1
    if success.any() and not success.all():
        succeeded = np.zeros(cells, bool)
        succeeded[cell[success]] = True
        in_race = success | ~succeeded.take(cell)
        rivals, cell = rivals[in_race], cell[in_race]
    objective = objective.take(rivals)
    highest = np.full(cells, -np.inf)
    np.maximum.at(highest, cell, objective)
    best = np.flatnonzero(objective == highest.take(cell))
    rivals, cell = rivals.take(best), cell.take(best)
    # Of several assignments to a cell the last one stays, here that of the earliest.
    earliest = np.empty(cells, np.intp)
    earliest[cell[::-1]] = rivals[::-1]
    winners: NDArray[np.intp] = rivals[rivals == earliest.take(cell)]
    return winners
