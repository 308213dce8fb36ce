"""What every search method looks like from outside, and what it needs to know of solutions."""

from collections.abc import Mapping
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from lqd_envs.errors import LQDError
from lqd_search.evaluation.values import Values


class MethodError(LQDError):
    """A method was called out of turn, or made of what does not fit."""


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


class Method(Protocol):
    """A search with a fixed number of evaluations, of which it uses every one.

    `ask` and `tell` take turns until it is `done`. Solutions are numbered from 0 in the order in
    which they are asked for; this number is their evaluation. A method can be pickled between
    `tell` and `ask`, and goes on bit for bit as if it had not been.
    """

    @property
    def done(self) -> bool:
        """Whether all evaluations are spent."""

    @property
    def evaluations(self) -> int:
        """Number of evaluations told so far."""

    @property
    def stage(self) -> str:
        """What the method is doing now, in a few words for a progress bar."""

    def ask(self) -> NDArray[np.float64]:
        """Return the next (n, dim) solutions to evaluate."""

    def tell(self, values: Values) -> None:
        """Take what the solutions asked for last came to."""

    def output(self) -> Mapping[str, NDArray[Any]]:
        """Return what the method puts out: distinct solutions, one column for each field.

        Among the fields are `solution`, `objective`, `success` (bool, the inferred condition) and
        `evaluation`.
        """
