"""The emitter of MAP-Elites Success: parents from every grid, successes first, varied."""

import numpy as np
from numpy.typing import NDArray

from lqd_search.archives.multi_bd_archive import MultiBDArchive
from lqd_search.emitters.emitter import Evaluated
from lqd_search.emitters.screen import Screen
from lqd_search.emitters.selection import SelectionError, select_parents
from lqd_search.emitters.shares import EvenShares, Shares
from lqd_search.emitters.variation import Mutation, Variation
from lqd_search.solution_space import SolutionSpace


class MESEmitter:
    """Selects parents from every grid, successes first, and makes a child of each.

    With its defaults it is that of the paper: the grids with elites share the generation evenly,
    and each child is a mutant. It implements `Emitter`.

    Args:
        space: Mutates.
        shares: How many parents each grid selects.
        variation: How a parent becomes a child; by default `Mutation(space)`.
        screen: Drops children that are not worth an evaluation before they are asked for; None:
            all of them are.
    """

    def __init__(
        self,
        space: SolutionSpace,
        *,
        shares: Shares | None = None,
        variation: Variation | None = None,
        screen: Screen | None = None,
    ) -> None:
        self._shares = EvenShares() if shares is None else shares
        self._variation = Mutation(space) if variation is None else variation
        self._screen = screen
        self._asked: dict[str, int] = {}

    def ask(
        self, n: int, *, archive: MultiBDArchive, rng: np.random.Generator
    ) -> NDArray[np.float64]:
        """Make n children.

        Args:
            n: How many.
            archive: Where the parents are; it has at least one elite.
            rng: Selects and varies, grid by grid.

        Returns:
            (n, dim) float64, the children of one grid after those of another.

        Raises:
            SelectionError: The archive has no elite.
        """
        grids = {name: grid for name, grid in archive.grids.items() if not grid.empty}
        if not grids:
            raise SelectionError(
                f"Expected an archive with at least one elite to select {n} parents from, but got "
                "an empty one; sample the first solutions from the space."
            )
        self._asked = self._shares.split(n, grids=grids)
        children = [
            self._children(name, count, archive=archive, rng=rng)
            for name, count in self._asked.items()
        ]
        return np.concatenate(children) if children else np.empty((0, archive.fields.solution_dim))

    def tell(self, batch: Evaluated, *, archive: MultiBDArchive) -> None:
        """Let the shares and the screen learn.

        Args:
            batch: What was evaluated.
            archive: The archive, after it.
        """
        del archive
        if self._screen is not None:
            self._screen.tell(batch)
        if batch.asked:
            names = np.repeat(list(self._asked), list(self._asked.values()))
            found = {name: int(batch.found[names == name].sum()) for name in self._asked}
            self._shares.tell(asked=self._asked, found=found)

    def _children(
        self, name: str, n: int, *, archive: MultiBDArchive, rng: np.random.Generator
    ) -> NDArray[np.float64]:
        elites = archive.grid_elites(name)
        parents = select_parents(n, success=elites["success"], rng=rng)
        children = self._variation(elites, parents, rng=rng)
        if self._screen is None or not self._screen.ready:
            return children
        again = [
            self._variation(elites, parents, rng=rng) for _ in range(self._screen.candidates - 1)
        ]
        return self._screen.choose(np.stack([children, *again]))
