"""What a search needs to know of solutions, and a box of them."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lqd_envs.errors import LQDError


class SpaceError(LQDError):
    """A solution space that makes no sense."""


class SolutionSpace(Protocol):
    """Where solutions come from."""

    @property
    def dim(self) -> int:
        """Length of a solution."""

    def sample(self, n: int, *, rng: np.random.Generator) -> NDArray[np.float64]:
        """Draw (n, dim) solutions uniformly."""

    def mutate(
        self, parents: NDArray[np.float64], *, rng: np.random.Generator
    ) -> NDArray[np.float64]:
        """Mutate each of the (n, dim) parents, and repair what came out."""


class RepairingSpace(SolutionSpace, Protocol):
    """A space that brings solutions back which something else than itself made."""

    def repair(self, solutions: NDArray[np.float64]) -> NDArray[np.float64]:
        """Bring (n, dim) finite solutions back into the space; feasible ones are left alone."""


class DirectedSpace(SolutionSpace, Protocol):
    """A space that knows the shortest way from one solution to another."""

    def difference(
        self, solutions: NDArray[np.float64], others: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return what leads from each of the (n, dim) others to each of the (n, dim) solutions."""


def require_method(space: SolutionSpace, name: str) -> None:
    """Check that a space can do more than every space can.

    Args:
        space: The space.
        name: Of a method, such as `repair`.

    Raises:
        SpaceError: It does not have it.
    """
    if not callable(getattr(space, name, None)):
        raise SpaceError(
            f"Expected a solution space with the method {name}(), but {type(space).__name__} has "
            "none; write it, as lqd_search.BoxSpace does, or choose another emitter."
        )


@dataclass(frozen=True, eq=False)
class BoxSpace:
    """Solutions in a box, varied by Gaussian mutation and brought back by clipping.

    It is a `RepairingSpace` and a `DirectedSpace`.

    Attributes:
        lower: (dim,) lower bounds.
        upper: (dim,) upper bounds.
        std: Standard deviation of the mutation, in shares of the box's width, at least 0.

    Raises:
        SpaceError: The bounds differ in length or are not finite, an upper one is not above its
            lower one, the box is too wide for a float, or the standard deviation is negative.
    """

    lower: ArrayLike
    upper: ArrayLike
    std: float = 0.1

    def __post_init__(self) -> None:
        lower, upper = np.array(self.lower, np.float64), np.array(self.upper, np.float64)
        if lower.shape != upper.shape or lower.ndim != 1 or not len(lower):
            raise SpaceError(
                "Expected lower and upper bounds of one shape (dim,), but got "
                f"{lower.shape} and {upper.shape}; give one of each for each number."
            )
        with np.errstate(over="ignore", invalid="ignore"):
            width = upper - lower
        if not (np.isfinite(width) & (width > 0.0)).all():
            raise SpaceError(
                f"Expected finite lower bounds below the upper ones, but got {lower.tolist()} and "
                f"{upper.tolist()}; correct them."
            )
        if not 0.0 <= self.std < np.inf:
            raise SpaceError(
                f"Expected a finite standard deviation of at least 0 for the mutation, but got "
                f"{self.std}; choose another."
            )
        object.__setattr__(self, "lower", lower)
        object.__setattr__(self, "upper", upper)

    @property
    def dim(self) -> int:
        """Length of a solution."""
        return np.asarray(self.lower).size

    def sample(self, n: int, *, rng: np.random.Generator) -> NDArray[np.float64]:
        """Draw (n, dim) solutions uniformly."""
        lower, upper = np.asarray(self.lower, np.float64), np.asarray(self.upper, np.float64)
        return rng.uniform(lower, upper, (n, self.dim))

    def mutate(
        self, parents: NDArray[np.float64], *, rng: np.random.Generator
    ) -> NDArray[np.float64]:
        """Add Gaussian noise to each of the (n, dim) parents, and repair."""
        width = np.asarray(self.upper, np.float64) - np.asarray(self.lower, np.float64)
        noise = self.std * width * rng.standard_normal(np.shape(parents))
        return self.repair(parents + noise)

    def repair(self, solutions: NDArray[np.float64]) -> NDArray[np.float64]:
        """Clip (n, dim) solutions at the bounds."""
        lower, upper = np.asarray(self.lower, np.float64), np.asarray(self.upper, np.float64)
        return np.clip(solutions, lower, upper)

    def difference(
        self, solutions: NDArray[np.float64], others: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return the (n, dim) solutions less the (n, dim) others."""
        return solutions - others
