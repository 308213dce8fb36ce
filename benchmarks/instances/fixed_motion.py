"""The control: one fixed motion of an archive, for all instances of a kind."""

from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from benchmarks.instances.looked_at import LookedAt

Choice = Callable[[NDArray[np.bool_]], NDArray[np.bool_]]
"""Returns (i,) in which instances the motion that is chosen solves, of (i, n) in which instances
each motion does; there is at least one instance and one motion."""


def in_hindsight(solves: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Choose the motion that solves the most instances: no fixed one solves more of them.

    Of equally good ones the first is chosen.

    Args:
        solves: (i, n) whether each motion solves each instance.
    """
    return np.asarray(solves[:, np.argmax(solves.sum(axis=0))])


def on_the_others(solves: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Choose, for each instance, the motion that solves the most of all the others.

    It is what a fixed motion is worth where the instance was not known when it was chosen. Of
    equally good ones the first is chosen.

    Args:
        solves: (i, n) whether each motion solves each instance.
    """
    others = solves.sum(axis=0) - solves
    return np.asarray(solves[np.arange(len(solves)), np.argmax(others, axis=1)])


HINDSIGHT, LEAVE_ONE_OUT = "hindsight", "leave-one-out"

CHOICES: Mapping[str, Choice] = MappingProxyType(
    {HINDSIGHT: in_hindsight, LEAVE_ONE_OUT: on_the_others}
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


def solved_by_one(row: Sequence[LookedAt], choice: str) -> NDArray[np.bool_]:
    """Return (i,) in which instances the fixed motion of an archive solves.

    Where no motion was looked at in all instances, none does.

    Args:
        row: What of the archive was looked at, instance by instance.
        choice: How the motion is chosen, one of `CHOICES`.
    """
    solves = solves_of(row)
    return CHOICES[choice](solves) if solves.shape[1] else np.zeros(len(row), dtype=bool)
