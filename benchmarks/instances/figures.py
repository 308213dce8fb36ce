"""The figures of an archive in an instance, each a probability."""

from collections.abc import Iterable
from dataclasses import dataclass

from benchmarks.instances.chance import chance
from benchmarks.instances.declared import SIZES, SUBSETS, TRIES
from benchmarks.instances.judgement import FilterFigures
from lqd_search.adaptation import SELECTORS

RANDOM = "random"
"""Choosing at random, beside the selectors."""


@dataclass(frozen=True)
class SomeMotion:
    """The probability that some motion of an archive solves an instance.

    Attributes:
        size: Of a random subset of so many motions; None: of all that were judged.
    """

    size: int | None = None

    def of(self, figures: FilterFigures) -> float:
        """Return the probability."""
        size = figures.judged if self.size is None else self.size
        return float(chance(figures.judged, figures.solved, size))


@dataclass(frozen=True)
class Success:
    """The probability that one of the first motions that a selector tries solves an instance.

    Attributes:
        selector: Name of the selector, or `RANDOM`.
        tries: How many are tried, one of `TRIES`.
        size: Choosing from a random subset of so many motions; None: from the whole archive.
    """

    selector: str
    tries: int
    size: int | None = None

    def of(self, figures: FilterFigures) -> float:
        """Return the probability."""
        if self.selector == RANDOM:
            return float(chance(figures.judged, figures.solved, self.tries))
        counts = figures.subsets[self.selector].get(str(self.size))
        if counts is None:
            # There are no more than that: it chooses from the whole archive.
            return float(0 < figures.first[self.selector] <= self.tries)
        return counts[TRIES.index(self.tries)] / SUBSETS


Figure = SomeMotion | Success

CONTROL = Success("best", 1)
"""The archive's best single motion: without an archive one would have that."""


def whole_archive() -> list[Figure]:
    """Return the figures of whole archives."""
    chosen = [Success(name, tries) for name in (*SELECTORS, RANDOM) for tries in TRIES]
    return [SomeMotion(), *chosen]


def by_size(*, judged: int, cap: int) -> list[Figure]:
    """Return the figures against the archive's size.

    Args:
        judged: The largest number of motions that were judged of an archive.
        cap: Most motions in a sample, from which the selectors' subsets are drawn.
    """
    some: Iterable[Figure] = (SomeMotion(size) for size in SIZES if size < judged)
    chosen: Iterable[Figure] = (
        Success(name, tries, size)
        for name in SELECTORS
        for tries in TRIES
        for size in SIZES
        if size < min(judged, cap)
    )
    return [*some, *chosen]
