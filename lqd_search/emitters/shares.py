"""How the parents of a generation are shared out to the grids."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from ribs.archives import GridArchive

from lqd_search.emitters.emitter import EmitterError


class Shares(Protocol):
    """Decides how many parents each grid selects."""

    def split(self, n: int, *, grids: Mapping[str, GridArchive]) -> dict[str, int]:
        """Share n parents between grids.

        Args:
            n: How many.
            grids: The grids that have elites, at least one, in the descriptors' order.

        Returns:
            For each grid that gets any, in this order, how many.
        """

    def tell(self, *, asked: Mapping[str, int], found: Mapping[str, int]) -> None:
        """Learn what became of the last split.

        Args:
            asked: For each grid how many of its children were evaluated.
            found: For each of them how many of these were successes that got into some cell.
        """


@dataclass(frozen=True)
class EvenShares:
    """The paper's rule: every grid selects as many parents.

    What does not divide goes to the first of them, in the descriptors' order.
    """

    def split(self, n: int, *, grids: Mapping[str, GridArchive]) -> dict[str, int]:
        """Share n parents evenly."""
        share, rest = divmod(n, len(grids))
        counts = {name: share + (i < rest) for i, name in enumerate(grids)}
        return {name: count for name, count in counts.items() if count}

    def tell(self, *, asked: Mapping[str, int], found: Mapping[str, int]) -> None:
        """Learn nothing."""


@dataclass(frozen=True)
class ManyCellShares:
    """Leaves out the grids with a single cell, which tell no two motions apart.

    Attributes:
        inner: Shares between the others; between all, if each has a single cell.
    """

    inner: Shares = field(default_factory=EvenShares)

    def split(self, n: int, *, grids: Mapping[str, GridArchive]) -> dict[str, int]:
        """Share n parents between the grids with several cells."""
        several = {name: grid for name, grid in grids.items() if grid.cells > 1}
        return self.inner.split(n, grids=several or grids)

    def tell(self, *, asked: Mapping[str, int], found: Mapping[str, int]) -> None:
        """Let the inner rule learn."""
        self.inner.tell(asked=asked, found=found)


@dataclass
class CreditedShares:
    """Gives more parents to the grids whose children found more of late.

    A grid's credit is the share of its children that were successes and got into some cell, both
    counts fading from generation to generation. A part of the parents is shared evenly, so that no
    grid is given up; the rest in proportion to the credit.

    Attributes:
        even: Part that is shared evenly, in [0, 1].
        fading: What is left of a count after a generation, in [0, 1).
        asked: The faded number of children of each grid.
        found: The faded number of them that found something.

    Raises:
        EmitterError: A part is not in its interval.
    """

    even: float = 0.5
    fading: float = 0.7
    asked: dict[str, float] = field(default_factory=dict)
    found: dict[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not (0.0 <= self.even <= 1.0 and 0.0 <= self.fading < 1.0):
            raise EmitterError(
                "Expected an even part from 0 to 1 and a fading from 0 to below 1, but got "
                f"{self.even} and {self.fading}; choose others."
            )

    def split(self, n: int, *, grids: Mapping[str, GridArchive]) -> dict[str, int]:
        """Share n parents by credit; as long as nothing was found, evenly."""
        credit = np.array(
            [self.found.get(k, 0.0) / max(self.asked.get(k, 0.0), 1.0) for k in grids]
        )
        even = np.full(len(grids), 1.0 / len(grids))
        by_credit = credit / credit.sum() if credit.sum() > 0 else even
        wanted = n * (self.even * even + (1.0 - self.even) * by_credit)
        counts = np.floor(wanted).astype(int)
        # The largest remainders get what rounding left over; a stable sort keeps the order of ties.
        left = np.argsort(counts - wanted, kind="stable")[: n - counts.sum()]
        counts[left] += 1
        return {name: int(count) for name, count in zip(grids, counts, strict=True) if count}

    def tell(self, *, asked: Mapping[str, int], found: Mapping[str, int]) -> None:
        """Let the counts fade, and add the new ones."""
        for counts, news in ((self.asked, asked), (self.found, found)):
            for name in {**counts, **news}:
                counts[name] = self.fading * counts.get(name, 0.0) + news.get(name, 0)
