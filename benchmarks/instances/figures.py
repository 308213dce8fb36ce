"""The figures of an archive in an instance, each a probability."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from benchmarks.instances.chance import chance
from benchmarks.instances.declared import SIZES, SUBSETS, TRIES
from benchmarks.instances.fixed_motion import HINDSIGHT, OTHER_HALF, solved_by_one
from benchmarks.instances.judged_run import InstancesError
from benchmarks.instances.judgement import FilterFigures
from lqd_search.adaptation import SELECTORS

RANDOM = "random"
"""Choosing at random, beside the selectors."""


@dataclass(frozen=True)
class SomeMotion:
    """The probability that some motion of an archive solves an instance.

    Attributes:
        size: Of a random subset of so many motions; None: of all that were looked at, those that
            selectors choose among them, so that no selector's success is above it.
    """

    size: int | None = None

    def of(self, figures: FilterFigures) -> float:
        """Return the probability."""
        if self.size is None:
            return float(figures.looked_at.solving > 0)
        return float(chance(figures.judged, figures.solved, self.size))


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
        """Return the probability.

        Raises:
            InstancesError: It was not counted for subsets of this size.
        """
        if self.selector == RANDOM:
            return float(chance(figures.judged, figures.solved, self.tries))
        # Where there are no more motions than that, it chooses from the whole archive.
        if self.size is None or self.size >= figures.motions:
            return float(0 < figures.first[self.selector] <= self.tries)
        counts = figures.subsets[self.selector].get(str(self.size))
        if counts is None:
            raise InstancesError(
                f"Expected what `{self.selector}` chooses from subsets of {self.size:,} motions, "
                "but the judgement does not have that size; delete it, and it is made again."
            )
        return counts[TRIES.index(self.tries)] / SUBSETS


@dataclass(frozen=True)
class FixedMotion:
    """How often one fixed motion of an archive, chosen for many instances, solves an instance.

    It is chosen among the motions that were looked at in every instance.

    Attributes:
        choice: How it is chosen, one of `CHOICES`.
    """

    choice: str

    def of(self, row: Sequence[FilterFigures]) -> list[float]:
        """Return it for each instance.

        Args:
            row: The figures of one archive, instance by instance.
        """
        return solved_by_one([one.looked_at for one in row], self.choice).tolist()


Figure = SomeMotion | Success | FixedMotion

HIGHEST_FITNESS = Success("best", 1)
"""A control: the archive's motion of the highest fitness."""
BEST_IN_HINDSIGHT = FixedMotion(HINDSIGHT)
"""A control: no fixed motion of the archive that was looked at solves more instances."""
BEST_ON_THE_OTHER_HALF = FixedMotion(OTHER_HALF)
"""A control: the fixed motion that solves the most of the half that the instance is not in."""


def values_of(figure: Figure, row: Sequence[FilterFigures]) -> list[float]:
    """Return a figure of one archive, instance by instance."""
    if isinstance(figure, FixedMotion):
        return figure.of(row)
    return [figure.of(one) for one in row]


def fixed_motions(*, instances: int) -> list[FixedMotion]:
    """Return the figures of one fixed motion.

    Args:
        instances: How many there are; a single one has no halves.
    """
    if instances == 1:
        return [BEST_IN_HINDSIGHT]
    return [BEST_IN_HINDSIGHT, BEST_ON_THE_OTHER_HALF]


def whole_archive() -> list[SomeMotion | Success]:
    """Return the figures of whole archives."""
    chosen = [Success(name, tries) for name in (*SELECTORS, RANDOM) for tries in TRIES]
    return [SomeMotion(), *chosen]


def by_size(*, judged: int, cap: int) -> list[SomeMotion | Success]:
    """Return the figures against the archive's size.

    Args:
        judged: The largest number of motions that were judged of an archive.
        cap: Most motions in a sample, from which the selectors' subsets are drawn.
    """
    some: Iterable[SomeMotion] = (SomeMotion(size) for size in SIZES if size < judged)
    chosen: Iterable[Success] = (
        Success(name, tries, size)
        for name in SELECTORS
        for tries in TRIES
        for size in SIZES
        if size < min(judged, cap)
    )
    return [*some, *chosen]
