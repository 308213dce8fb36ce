"""The control: one fixed motion of an archive, for all instances of a kind."""

from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from benchmarks.instances.looked_at import LookedAt

SPLITS = 200
"""How often the instances are halved."""
_SPLIT_SEED = 20_261_123

Choice = Callable[[NDArray[np.bool_]], NDArray[np.float64]]
"""Returns (i,) how often the motion that is chosen solves each instance, from 0 to 1, of (i, n) in
which instances each motion does; there is at least one instance and one motion."""


def in_hindsight(solves: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Choose the motion that solves the most instances: no fixed one solves more of them.

    Of equally good ones the first is chosen.

    Args:
        solves: (i, n) whether each motion solves each instance.
    """
    return solves[:, np.argmax(solves.sum(axis=0))].astype(float)


def on_the_other_half(solves: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Choose the motion that solves the most of one half of the instances, for the other half.

    It is what a fixed motion is worth where the instance was not known when it was chosen, by half
    as many instances as there are; by more of them a better one might be chosen. The instances are
    halved at random `SPLITS` times, and each half chooses for the other one; where their number is
    odd, one half has one more. Of equally good ones the first is chosen.

    To choose by all instances but one would be no more biased, but far noisier: which of many
    nearly equal motions leads would decide on all or nothing.

    Args:
        solves: (i, n) whether each motion solves each instance, at least two of them.
    """
    half = _halves(len(solves))
    solved = np.zeros(len(solves))
    for choosing in (half, ~half):
        chosen = np.argmax(choosing.astype(float) @ solves, axis=1)
        solved += np.where(choosing, False, solves[:, chosen].T).sum(axis=0)
    return solved / SPLITS


HINDSIGHT, OTHER_HALF = "hindsight", "other half"

CHOICES: Mapping[str, Choice] = MappingProxyType(
    {HINDSIGHT: in_hindsight, OTHER_HALF: on_the_other_half}
)
"""How the fixed motion is chosen."""


def solves_of(row: Sequence[LookedAt]) -> NDArray[np.bool_]:
    """Return (i, n) in which instances the motions solve that were looked at in all of them.

    The motions are in the order of their evaluation numbers.

    Args:
        row: What of one archive was looked at, instance by instance.
    """
    masks = [one.masks() for one in row]
    everywhere = np.logical_and.reduce([which for which, _ in masks])
    return np.stack([solve[everywhere] for _, solve in masks])


def solved_by_one(row: Sequence[LookedAt], choice: str) -> NDArray[np.float64]:
    """Return (i,) how often the fixed motion of an archive solves each instance, from 0 to 1.

    Where no motion was looked at in all instances, none does.

    Args:
        row: What of the archive was looked at, instance by instance.
        choice: How the motion is chosen, one of `CHOICES`.
    """
    solves = solves_of(row)
    return CHOICES[choice](solves) if solves.shape[1] else np.zeros(len(row))


def _halves(instances: int) -> NDArray[np.bool_]:
    """Return (`SPLITS`, i) which instances are in the first half, the same for all archives."""
    rng = np.random.default_rng(_SPLIT_SEED)
    first = np.arange(instances) < instances // 2
    return rng.permuted(np.tile(first, (SPLITS, 1)), axis=1)
