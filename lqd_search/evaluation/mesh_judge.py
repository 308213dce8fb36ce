"""Judging by functionals of one's own and their BD mesh."""

from collections.abc import Iterator

import numpy as np

from lqd_envs import Infos, Trajectories
from lqd_search.evaluation.functionals import FunctionalEvaluator
from lqd_search.evaluation.values import Values


class MeshJudge:
    """Judges motions by one success, several fitness functions and the descriptors of a BD mesh.

    It implements `Judge`. The functionals are called in this process: those that a model wrote run
    in the sandbox instead, with the same values.

    Args:
        functionals: Turns the moments of motions into values.

    Attributes:
        fitness_names: As of the functionals.
        descriptors: As of the functionals.
        dropped: As of the functionals.
    """

    def __init__(self, functionals: FunctionalEvaluator) -> None:
        self._functionals = functionals
        self.fitness_names = functionals.fitness_names
        self.descriptors = functionals.descriptors
        self.dropped = functionals.dropped

    def __call__(self, trajectories: Trajectories) -> Values:
        """Judge N motions."""
        return self._functionals(_motions(trajectories), valid=trajectories.valid)


def _motions(trajectories: Trajectories) -> Iterator[tuple[int, Infos]]:
    for i in np.flatnonzero(trajectories.valid):
        yield int(i), trajectories.infos(int(i))
