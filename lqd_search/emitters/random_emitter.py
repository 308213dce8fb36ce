"""Random solutions, whatever the archive holds."""

import numpy as np
from numpy.typing import NDArray

from lqd_search.archives.multi_bd_archive import MultiBDArchive
from lqd_search.emitters.emitter import Evaluated
from lqd_search.solution_space import SolutionSpace


class RandomEmitter:
    """Draws uniformly from the space: what the paper names as reinjection. An `Emitter`.

    Args:
        space: Where they come from.
    """

    def __init__(self, space: SolutionSpace) -> None:
        self._space = space

    def ask(
        self, n: int, *, archive: MultiBDArchive, rng: np.random.Generator
    ) -> NDArray[np.float64]:
        """Draw (n, dim) solutions."""
        del archive
        return self._space.sample(n, rng=rng)

    def tell(self, batch: Evaluated, *, archive: MultiBDArchive) -> None:
        """Learn nothing."""
