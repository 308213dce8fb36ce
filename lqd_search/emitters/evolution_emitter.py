"""CMA-ME inside the multi-BD search: pyribs' evolution strategies, started on some of its grids."""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from ribs.archives import ArchiveBase
from ribs.emitters import EvolutionStrategyEmitter
from ribs.typing import BatchData, Int

from lqd_search.archives.multi_bd_archive import MultiBDArchive
from lqd_search.emitters.emitter import EmitterError, Evaluated
from lqd_search.solution_space import RepairingSpace, require_method

# Greater than any improvement that a fitness is likely to make, and still a number that CMA-ES can
# compute with.
_LARGEST = 1e12


class EvolutionEmitter:
    """pyribs' improvement emitters on grids whose measures are always defined. An `Emitter`.

    Each of a few strategies is a CMA-ES that starts at a success of such a grid (at any elite
    where it has none) and follows improvement (Fontaine et al., 2020): solutions in new cells rank
    first, then those that took a cell over, then the rest, and within each by how much better they
    are than the elite before. New cells and improvements count over all grids of the archive. A
    strategy that improves nothing starts anew at another success.

    Args:
        space: Brings solutions back.
        strategies: How many strategies share what is asked for; fewer where that is less.
        sigma0: Their first step size, in units of a solution.

    Raises:
        EmitterError: There is no strategy, or the step size is not finite and above 0.
        SpaceError: The space cannot repair.
    """

    def __init__(self, space: RepairingSpace, *, strategies: int = 3, sigma0: float = 0.2) -> None:
        if strategies < 1 or not 0.0 < sigma0 < np.inf:
            raise EmitterError(
                "Expected at least 1 strategy and a finite first step size above 0, but got "
                f"{strategies} and {sigma0}; choose others."
            )
        require_method(space, "repair")
        self._space = space
        self._count = strategies
        self._sigma0 = sigma0
        self._undefined: set[str] = set()
        self._strategies: list[tuple[_Starts, EvolutionStrategyEmitter]] = []
        self._asked = 0

    def ask(
        self, n: int, *, archive: MultiBDArchive, rng: np.random.Generator
    ) -> NDArray[np.float64]:
        """Ask the strategies for n solutions.

        Args:
            n: How many; another number than the last time starts new strategies.
            archive: Where these start.
            rng: Seeds them.

        Returns:
            (n, dim) float64.
        """
        if n != self._asked:
            self._strategies = self._started(n, archive=archive, rng=rng)
            self._asked = n
        solutions = [strategy.ask() for _, strategy in self._strategies]
        empty = np.empty((0, archive.fields.solution_dim))
        return self._space.repair(np.concatenate([empty, *solutions]))

    def tell(self, batch: Evaluated, *, archive: MultiBDArchive) -> None:
        """Let each strategy rank its solutions and adapt.

        Args:
            batch: What was evaluated.
            archive: The archive, after it.
        """
        for name, measures in batch.values.measures.items():
            if np.isnan(measures[batch.values.valid, 0]).any():
                self._undefined.add(name)
        if not batch.asked:
            return
        first = 0
        for starts, strategy in self._strategies:
            own = slice(first, first + strategy.batch_size)
            first = own.stop
            starts.pool = _pool(starts.grid, archive)
            strategy.tell(
                solution=batch.solutions[own],
                objective=np.nan_to_num(batch.objective[own]),
                measures=np.empty((strategy.batch_size, 0)),
                add_info={
                    "status": batch.status[own],
                    "value": np.clip(batch.value[own], -_LARGEST, _LARGEST),
                },
            )
            starts.pool = None

    def _started(
        self, n: int, *, archive: MultiBDArchive, rng: np.random.Generator
    ) -> list[tuple["_Starts", EvolutionStrategyEmitter]]:
        grids = [name for name, grid in archive.grids.items() if not grid.empty]
        # Where no grid is always defined, one that is not will do: only starts come from it.
        best = [
            g for g in grids if g not in self._undefined and archive.grids[g].cells > 1
        ] or grids
        count = min(self._count, n)
        strategies = []
        for i, size in enumerate(n // count + (j < n % count) for j in range(count)):
            seed = int(rng.integers(2**32))
            starts = _Starts(best[i % len(best)], archive.fields.solution_dim, seed=seed)
            starts.pool = _pool(starts.grid, archive)
            # pyribs takes half of the solutions for parents, of a single one none, and divides by
            # their number.
            with np.errstate(invalid="ignore"):
                strategy = EvolutionStrategyEmitter(
                    starts,
                    x0=starts.sample_elites(1)["solution"][0],
                    sigma0=self._sigma0,
                    ranker="2imp",
                    batch_size=size,
                    seed=seed,
                )
            starts.pool = None
            strategies.append((starts, strategy))
        return strategies


class _Starts(ArchiveBase):
    """What an `EvolutionStrategyEmitter` needs of an archive: where a strategy may start.

    It has no measures, since the improvement ranker reads only the status and the value.
    """

    def __init__(self, grid: str, solution_dim: int, *, seed: int) -> None:
        super().__init__(solution_dim=solution_dim, objective_dim=(), measure_dim=0)
        self.grid = grid
        # Set only while a strategy is at work, so that a checkpoint does not hold it.
        self.pool: NDArray[np.float64] | None = None
        self._rng = np.random.default_rng(seed)

    @property
    def dtypes(self) -> dict[str, Any]:
        return dict.fromkeys(("solution", "objective", "measures"), np.dtype(np.float64))

    def sample_elites(self, n: Int, replace: bool = True) -> BatchData:
        if self.pool is None or not replace:
            raise AssertionError("a strategy starts anew only while it is told, and anywhere")
        return {"solution": self.pool[self._rng.integers(len(self.pool), size=n)]}


def _pool(grid: str, archive: MultiBDArchive) -> NDArray[np.float64]:
    """Return the successes of a grid, or all its elites where it has none."""
    # Learning the ranges again may leave a descriptor without a grid.
    there = grid in archive.grids and not archive.grids[grid].empty
    elites = archive.grid_elites(grid) if there else archive.elites().fields
    chosen = elites["success"] if elites["success"].any() else slice(None)
    return np.asarray(elites["solution"][chosen])
