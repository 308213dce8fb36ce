"""Judging by one success, one fitness and one descriptor, as the paper's naive inference has them.

The functions are called in this process, so they are for code of one's own. Code that a model wrote
belongs in `lqd_llm.sandbox`, where `lqd run` calls it.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from lqd_envs import Trajectories
from lqd_envs.perception import (
    DescriptorFunction,
    FitnessFunction,
    Infos,
    SuccessFunction,
)
from lqd_search.evaluation.functional_calls import (
    RefusedValueError,
    call_descriptor,
    call_fitness,
    call_success,
)
from lqd_search.evaluation.functionals import FunctionalError
from lqd_search.evaluation.refusals import Refusals
from lqd_search.evaluation.values import Values

DIRECT = "direct"
"""Name of the fitness and of the descriptor."""


@dataclass(frozen=True)
class DirectFunctionals:
    """Three functions of one's own, of the kinds that a model is asked for all at once.

    They are called in this process, and asked to be pure, as those of `Functionals` are.

    Attributes:
        success: Says whether a motion did the task.
        fitness: Rates one moment, higher is better.
        descriptor: Measures 2 to 5 numbers of a motion; None where they are not defined.
    """

    success: SuccessFunction
    fitness: FitnessFunction
    descriptor: DescriptorFunction


class DirectJudge:
    """Judges motions by one success, one fitness and one descriptor. It implements `Judge`.

    How many numbers the descriptor measures is fixed on the first example that it can measure.

    Args:
        functionals: The three functions.
        examples: Motions of the task, at least one.

    Attributes:
        fitness_names: `("direct",)`.
        descriptors: `direct` with its number of measures.
        dropped: Empty.

    Raises:
        FunctionalError: There is no example, or none that the descriptor can measure or the
            fitness can rate.
    """

    def __init__(self, functionals: DirectFunctionals, *, examples: Sequence[Infos]) -> None:
        self._functionals = functionals
        with np.errstate(all="ignore"):
            length = self._length(examples)
            self._require_fitness(examples)
        self.fitness_names: tuple[str, ...] = (DIRECT,)
        self.descriptors = {DIRECT: length}
        self.dropped: tuple[str, ...] = ()

    def __call__(self, trajectories: Trajectories) -> Values:
        """Judge N motions.

        What is refused is treated as by `FunctionalEvaluator`: a refused success counts as a
        failure, a refused fitness is NaN, and a refused descriptor is undefined.
        """
        n, refusals = len(trajectories), Refusals()
        success, fitness = np.zeros(n, bool), np.full(n, np.nan)
        measures = np.full((n, self.descriptors[DIRECT]), np.nan)
        # A value is judged by what it is: NumPy need not warn that a division made it NaN.
        with np.errstate(all="ignore"):
            for i in map(int, np.flatnonzero(trajectories.valid)):
                infos = trajectories.infos(i)
                try:
                    success[i] = call_success(self._functionals.success, infos)
                except RefusedValueError as refused:
                    refusals.note(i, "success", DIRECT, refused)
                try:
                    fitness[i] = call_fitness(self._functionals.fitness, infos)
                except RefusedValueError as refused:
                    refusals.note(i, "fitness", DIRECT, refused)
                try:
                    measures[i] = self._measures(infos)
                except RefusedValueError as refused:
                    refusals.note(i, "descriptor", DIRECT, refused)
        return Values(
            valid=trajectories.valid,
            success=success,
            fitness={DIRECT: fitness},
            measures={DIRECT: measures},
            refusals=refusals.listed(),
        )

    def _measures(self, infos: Infos) -> tuple[float, ...] | float:
        numbers = call_descriptor(self._functionals.descriptor, infos)
        if numbers is None:
            return math.nan
        length = self.descriptors[DIRECT]
        if len(numbers) != length:
            raise RefusedValueError(
                f"returned {len(numbers)} numbers, not {length} as on an example"
            )
        return numbers

    def _length(self, examples: Sequence[Infos]) -> int:
        why = "it is given none"
        for infos in examples:
            try:
                numbers = call_descriptor(self._functionals.descriptor, infos)
            except RefusedValueError as refused:
                why = f"on the last one it {refused}"
                continue
            if numbers is not None:
                return len(numbers)
            why = "it is not defined on the last one"
        raise FunctionalError(
            "Expected a direct descriptor that measures 2 to 5 finite numbers of an example "
            f"motion, but of {len(examples)} there is none: {why}; correct it."
        )

    def _require_fitness(self, examples: Sequence[Infos]) -> None:
        why = ""
        for infos in examples:
            try:
                call_fitness(self._functionals.fitness, infos)
            except RefusedValueError as refused:
                why = str(refused)
            else:
                return
        raise FunctionalError(
            "Expected a direct fitness that gives finite numbers on an example motion, but on the "
            f"last of {len(examples)} it {why}; correct it."
        )
