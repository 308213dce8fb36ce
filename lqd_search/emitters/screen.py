"""Dropping children that are not worth an evaluation, by what became of their neighbours."""

from collections.abc import Callable
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from lqd_search.emitters.emitter import EmitterError, Evaluated
from lqd_search.evaluation.values import Values


class Screen(Protocol):
    """Chooses which of several candidates are worth an evaluation."""

    @property
    def candidates(self) -> int:
        """Children to make for each one that is wanted."""

    @property
    def ready(self) -> bool:
        """Whether it has seen enough to choose."""

    def choose(self, candidates: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return (n, dim) children, one of each parent's out of (candidates, n, dim)."""

    def tell(self, batch: Evaluated) -> None:
        """Learn from a batch."""


Worth = Callable[[Values], NDArray[np.bool_]]
"""Values to (N,) bool: which solutions were worth their evaluation."""


def carried_out(values: Values) -> NDArray[np.bool_]:
    """Return (N,) bool: which motions were valid."""
    return values.valid


class NeighbourScreen:
    """Drops a child whose nearest evaluated neighbours were none of them worth their evaluation.

    Of uniform random motions most cannot be carried out at all: their start is out of reach or
    inside something. Where that is so is learned from the evaluations themselves. Each parent has
    several candidates; the first one is taken that has a neighbour which was worth it, or the first
    one of all where there is none.

    Neighbours are near by the Euclidean distance of their numbers as they are, so a yaw just below
    half a turn is far from one just above minus half a turn. It implements `Screen`.

    Args:
        candidates: Children to make for each one that is wanted, at least 1.
        neighbours: How many evaluated solutions have a say in each, at least 1.
        memory: How many of the last evaluated solutions are remembered, at least `neighbours`.
        worth: Which solutions were worth their evaluation.

    Attributes:
        candidates: As given.

    Raises:
        EmitterError: One of these numbers is too low.
    """

    def __init__(
        self,
        *,
        candidates: int = 3,
        neighbours: int = 3,
        memory: int = 20_000,
        worth: Worth = carried_out,
    ) -> None:
        if min(candidates, neighbours) < 1 or memory < neighbours:
            raise EmitterError(
                "Expected at least 1 candidate, at least 1 neighbour and a memory of at least as "
                f"many solutions as neighbours, but got {candidates}, {neighbours} and {memory}; "
                "raise what is too low."
            )
        self.candidates = candidates
        self._neighbours = neighbours
        self._memory = memory
        self._worth = worth
        self._solutions: NDArray[np.float64] | None = None
        self._was_worth = np.empty(0, bool)
        self._tree: cKDTree | None = None

    @property
    def ready(self) -> bool:
        """Whether it has seen as many solutions as have a say."""
        return len(self._was_worth) >= self._neighbours

    def choose(self, candidates: NDArray[np.float64]) -> NDArray[np.float64]:
        """Choose the first promising candidate of each parent.

        Args:
            candidates: (candidates, n, dim) float64.

        Returns:
            (n, dim) float64.
        """
        if self._tree is None:
            self._tree = cKDTree(self._solutions)
        _, nearest = self._tree.query(candidates, k=np.arange(1, self._neighbours + 1))
        promising = self._was_worth[nearest].any(axis=-1)
        # argmax gives the first promising one, and the first of all where none is.
        chosen = promising.argmax(axis=0)
        return np.asarray(candidates[chosen, np.arange(candidates.shape[1])])

    def tell(self, batch: Evaluated) -> None:
        """Remember which solutions were worth their evaluation."""
        known = [] if self._solutions is None else [self._solutions]
        self._solutions = np.concatenate([*known, batch.solutions])[-self._memory :]
        worth = self._worth(batch.values)
        self._was_worth = np.concatenate([self._was_worth, worth])[-self._memory :]
        self._tree = None

    def __getstate__(self) -> dict[str, Any]:
        """Return what a copy needs; the tree is grown again from the solutions."""
        return self.__dict__ | {"_tree": None}
