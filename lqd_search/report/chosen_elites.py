"""Which elites of an archive a report shows as rollouts."""

import numpy as np
from numpy.typing import NDArray

from lqd_envs import GroundTruth
from lqd_search.archives.worth import worth_of
from lqd_search.evaluation.motion_evaluator import EXPERT, GROUND_TRUTH
from lqd_search.runs.stored_archive import StoredArchive


def choose_elites(
    archive: StoredArchive, *, ground_truth: GroundTruth, n: int
) -> NDArray[np.int64]:
    """Choose the best success of each of n ground-truth cells that are well spread.

    The first cell is that of the success of the highest fitness. Each further one is the cell that
    is farthest from those chosen before, by its distance to the nearest of them, where the whole
    grid counts as 1 along each axis; of equally far ones, the first in the grid. Of each cell the
    success of the highest fitness is taken, of equal ones the earlier.

    Successes are those that the expert's condition approves; if it approves none, those that the
    inferred condition approves. What lies outside the grid is left out.

    Args:
        archive: What a run put out.
        ground_truth: Its task's grid.
        n: How many to choose at most.

    Returns:
        (k,) int64: rows of the archive in the order in which they were chosen, with k <= n.
    """
    fields = archive.fields
    success = fields[EXPERT] if fields[EXPERT].any() else fields["success"]
    cells = ground_truth.cells(fields[GROUND_TRUTH])
    candidates = np.flatnonzero(success & (cells >= 0))
    worth = worth_of(fields["objective"])
    order = candidates[np.lexsort((candidates, -worth[candidates], cells[candidates]))]
    filled, first = np.unique(cells[order], return_index=True)
    best = order[first]
    if not len(best) or n < 1:
        return np.zeros(0, dtype=np.int64)
    places = np.stack(np.unravel_index(filled, ground_truth.dims), axis=1) / ground_truth.dims
    start = int(np.lexsort((best, -worth[best]))[0])
    return best[_spread(places, start=start, n=min(n, len(best)))]


def _spread(places: NDArray[np.float64], *, start: int, n: int) -> list[int]:
    chosen = [start]
    distance = np.linalg.norm(places - places[start], axis=1)
    while len(chosen) < n:
        farthest = int(np.argmax(distance))
        chosen.append(farthest)
        distance = np.minimum(distance, np.linalg.norm(places - places[farthest], axis=1))
    return chosen
