"""Several emitters that share each generation."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from lqd_search.archives.multi_bd_archive import MultiBDArchive
from lqd_search.emitters.emitter import Emitter, EmitterError, Evaluated

# Far above what a product of floats is off by, and far below a share of one solution.
_ROUNDING = 1e-9


@dataclass(frozen=True)
class Part:
    """One emitter of several.

    Attributes:
        emitter: The emitter.
        share: Its part of each generation, above 0.
    """

    emitter: Emitter
    share: float


class MixedEmitter:
    """Asks several emitters for fixed shares of each generation. An `Emitter` itself.

    Args:
        main: Gets what the others leave.
        others: The others, in the order of their solutions after those of `main`; each gets its
            share, rounded down.

    Raises:
        EmitterError: A share is not above 0, or they leave nothing to the main one.
    """

    def __init__(self, main: Emitter, others: Sequence[Part]) -> None:
        shares = [part.share for part in others]
        if not all(share > 0.0 for share in shares) or sum(shares) >= 1.0:
            raise EmitterError(
                "Expected shares above 0 whose sum is below 1, so that something is left to the "
                f"main emitter, but got {shares}; lower them."
            )
        self._main = main
        self._others = tuple(others)
        self._asked: list[int] = []

    def ask(
        self, n: int, *, archive: MultiBDArchive, rng: np.random.Generator
    ) -> NDArray[np.float64]:
        """Ask each emitter for its share of n solutions, the main one first."""
        counts = [math.floor(part.share * n + _ROUNDING) for part in self._others]
        self._asked = [n - sum(counts), *counts]
        return np.concatenate(
            [
                emitter.ask(count, archive=archive, rng=rng)
                for emitter, count in zip(self._emitters, self._asked, strict=True)
            ]
        )

    def tell(self, batch: Evaluated, *, archive: MultiBDArchive) -> None:
        """Tell each emitter of all solutions: of its own as asked for, of the others' as not."""
        if not batch.asked:
            for emitter in self._emitters:
                emitter.tell(batch, archive=archive)
            return
        ends = np.cumsum(self._asked)
        for emitter, end, count in zip(self._emitters, ends, self._asked, strict=True):
            own = np.arange(end - count, end)
            others = np.setdiff1d(np.arange(len(batch)), own)
            emitter.tell(batch.rows(own), archive=archive)
            if len(others):
                emitter.tell(replace(batch.rows(others), asked=False), archive=archive)

    @property
    def _emitters(self) -> list[Emitter]:
        return [self._main, *(part.emitter for part in self._others)]
