"""What turns motions into the values that a search is told."""

from collections.abc import Mapping
from typing import Protocol

from lqd_envs import Trajectories
from lqd_search.evaluation.values import Values


class Judge(Protocol):
    """Judges motions by a success condition, fitness functions and descriptors."""

    @property
    def fitness_names(self) -> tuple[str, ...]:
        """The fitness functions, in order."""

    @property
    def descriptors(self) -> Mapping[str, int]:
        """For each descriptor, in order, its number of measures."""

    @property
    def dropped(self) -> tuple[str, ...]:
        """One sentence for each function that is not used."""

    def __call__(self, trajectories: Trajectories) -> Values:
        """Judge N motions; the values have no passive and no perceived columns."""
