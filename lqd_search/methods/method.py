"""What every search method looks like from outside, and what it needs to know of solutions."""

from collections.abc import Mapping
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from lqd_envs.errors import LQDError
from lqd_search.archives.multi_bd_archive import MultiBDArchive
from lqd_search.evaluation.values import Values


class MethodError(LQDError):
    """A method was called out of turn, or made of what does not fit."""


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

    @property
    def archive(self) -> MultiBDArchive | None:
        """The grids that are being filled; None: the method has none."""

    @property
    def exploration(self) -> Mapping[str, int]:
        """For each fitness that was tried the distinct successes that it led to, if any were."""

    @property
    def chosen(self) -> str | None:
        """The fitness that was kept after trying several; None before, or if none were tried."""

    def ask(self) -> NDArray[np.float64]:
        """Return the next (n, dim) solutions to evaluate."""

    def tell(self, values: Values) -> None:
        """Take what the solutions asked for last came to."""

    def output(self) -> Mapping[str, NDArray[Any]]:
        """Return what the method puts out: distinct solutions, one column for each field.

        Among the fields are `solution`, `objective`, `success` (bool, the inferred condition) and
        `evaluation`.
        """
