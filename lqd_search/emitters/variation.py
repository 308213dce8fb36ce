"""How parents become children: mutation, and lines between successes."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from ribs.typing import BatchData

from lqd_search.solution_space import DirectedSpace, SolutionSpace, require_method


class Variation(Protocol):
    """Makes a child of each parent."""

    def __call__(
        self, elites: BatchData, parents: NDArray[np.intp], *, rng: np.random.Generator
    ) -> NDArray[np.float64]:
        """Vary the parents.

        Args:
            elites: A column of m rows for each field of the elites of one grid.
            parents: (n,) rows of the parents.
            rng: Source of randomness.

        Returns:
            (n, dim) float64 children, in the parents' order.
        """


@dataclass(frozen=True)
class Mutation:
    """The paper's variation: each child is a mutant of its parent.

    Attributes:
        space: Mutates.
    """

    space: SolutionSpace

    def __call__(
        self, elites: BatchData, parents: NDArray[np.intp], *, rng: np.random.Generator
    ) -> NDArray[np.float64]:
        """Mutate the parents."""
        return self.space.mutate(elites["solution"][parents], rng=rng)


@dataclass(frozen=True)
class SuccessLine:
    """Iso+line variation between successes (Vassiliades and Mouret, 2018).

    A child of a success is a mutant of a point on the line from its parent to a success of the
    same grid, drawn uniformly; how far along is normally distributed around the parent. Children
    of failures are plain mutants, as are those of a grid's only success.

    Attributes:
        near: Mutates the points on the lines, more finely than `far`.
        far: Mutates the failures, and knows the way from one solution to another.
        line_std: Standard deviation of the place on the line, of which 0 is the parent and 1 the
            other success.

    Raises:
        SpaceError: `far` knows no way from one solution to another.
    """

    near: SolutionSpace
    far: DirectedSpace
    line_std: float = 0.2

    def __post_init__(self) -> None:
        require_method(self.far, "difference")

    def __call__(
        self, elites: BatchData, parents: NDArray[np.intp], *, rng: np.random.Generator
    ) -> NDArray[np.float64]:
        """Vary the parents."""
        solutions = elites["solution"][parents]
        children = self.far.mutate(solutions, rng=rng)
        successes = np.flatnonzero(elites["success"])
        lined = elites["success"][parents] & (len(successes) > 1)
        if not lined.any():
            return children
        count, starts = int(lined.sum()), solutions[lined]
        others = elites["solution"][rng.choice(successes, size=count)]
        along = self.line_std * rng.standard_normal((count, 1))
        points = starts + along * self.far.difference(others, starts)
        children[lined] = self.near.mutate(points, rng=rng)
        return children
