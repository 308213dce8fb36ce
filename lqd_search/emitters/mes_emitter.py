"""The emitter of MAP-Elites Success: parents from one grid, mutated."""

import numpy as np
from numpy.typing import NDArray

from lqd_search.archives.multi_bd_archive import MultiBDArchive
from lqd_search.emitters.selection import select_parents
from lqd_search.methods.method import SolutionSpace


class MESEmitter:
    """Selects parents from one grid of a multi-BD archive, successes first, and mutates them.

    Args:
        archive: The archive.
        name: The descriptor whose grid the parents come from.
        space: Mutates them.
    """

    def __init__(self, archive: MultiBDArchive, name: str, space: SolutionSpace) -> None:
        self._archive = archive
        self._name = name
        self._space = space

    def ask(self, n: int, *, rng: np.random.Generator) -> NDArray[np.float64]:
        """Make n new solutions.

        Args:
            n: How many.
            rng: Selects and mutates.

        Returns:
            (n, dim) float64.

        Raises:
            ArchiveError: The descriptor has no grid.
            SelectionError: Its grid is empty.
        """
        elites = self._archive.grid_elites(self._name)
        parents = select_parents(n, success=elites["success"], rng=rng)
        return self._space.mutate(elites["solution"][parents], rng=rng)
