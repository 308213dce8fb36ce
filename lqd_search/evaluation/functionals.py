"""Python functions that a search is steered by, and how they turn motions into values.

They are called in this process, so they are for code of one's own. Code that a model wrote belongs
in `lqd_llm.sandbox`, where `lqd run` calls it.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lqd_envs.errors import LQDError
from lqd_envs.perception import (
    FitnessFunction,
    Info,
    Infos,
    QuantityFunction,
    SuccessFunction,
    TimestampFunction,
)
from lqd_search.evaluation.functional_calls import (
    RefusedValueError,
    call_fitness,
    call_quantity,
    call_success,
    call_timestamp,
)
from lqd_search.evaluation.refusals import Refusals
from lqd_search.evaluation.trial import Trial, try_functions
from lqd_search.evaluation.values import Values


class FunctionalError(LQDError):
    """A set of functionals cannot be used."""


@dataclass(frozen=True)
class Functionals:
    """Functions of one's own that a search is steered by; they are called in this process.

    They are asked to be pure. Each is given a list of its own, which it may sort or empty, but the
    moments in it are the same ones for all functions of a motion: one that changed a moment would
    corrupt what the next one sees. Nothing here prevents that.

    Attributes:
        success: Says whether a motion did the task.
        fitness: The fitness functions, by name; each rates one moment, higher is better.
        timestamps: The functions h, by name; each picks one of a motion's moments, or None.
        quantities: The functions g, by name; each measures 2 to 5 numbers at a moment.

    Raises:
        FunctionalError: There is none of a kind, or a name is empty or has a dot.
    """

    success: SuccessFunction
    fitness: Mapping[str, FitnessFunction]
    timestamps: Mapping[str, TimestampFunction]
    quantities: Mapping[str, QuantityFunction]

    def __post_init__(self) -> None:
        for kind in ("fitness", "timestamps", "quantities"):
            names = tuple(getattr(self, kind))
            if not names or any(not name or "." in name for name in names):
                raise FunctionalError(
                    f"Expected at least one function in {kind}, with names without dots, but got "
                    f"the names {names}; add one, or rename it."
                )

    @property
    def descriptors(self) -> tuple[str, ...]:
        """Names of the BD mesh: `"h.g"` for each timestamp h, and within it each quantity g."""
        return tuple(f"{h}.{g}" for h in self.timestamps for g in self.quantities)


class FunctionalEvaluator:
    """Turns the moments of motions into values, by calling functionals on them in this process.

    How many numbers a quantity measures is fixed on the first example that it can measure. One
    that cannot measure any of them is dropped with its descriptors, and so is a fitness that
    cannot rate any of them.

    Args:
        functionals: The functions.
        examples: Moments of the task, at least one.

    Attributes:
        fitness_names: The fitness functions that are left, in order.
        descriptors: For each descriptor of the BD mesh that is left, in order, its number of
            measures.
        dropped: One sentence for each fitness and each quantity that was dropped.

    Raises:
        FunctionalError: There is no example, or no fitness or no quantity is left.
    """

    def __init__(self, functionals: Functionals, *, examples: Sequence[Info]) -> None:
        if not examples:
            raise FunctionalError(
                "Expected at least one example moment of the task, but got none; pass moments of "
                "valid motions."
            )
        rated = try_functions(
            "fitness", functionals.fitness, call=_call_on_moment, examples=examples
        )
        measured = try_functions(
            "quantity", functionals.quantities, call=call_quantity, examples=examples
        )
        _refuse_none("a fitness that gives a finite number", rated)
        _refuse_none("a quantity that measures 2 to 5 finite numbers", measured)
        self._functionals = functionals
        self._lengths = {name: len(numbers) for name, numbers in measured.results.items()}
        self.fitness_names = tuple(rated.results)
        self.dropped = rated.dropped + measured.dropped
        self.descriptors = {
            f"{h}.{g}": self._lengths[g] for h in functionals.timestamps for g in self._lengths
        }

    def __call__(self, motions: Iterable[tuple[int, Infos]], *, valid: NDArray[np.bool_]) -> Values:
        """Judge a batch.

        A value that is not what its function was asked for is refused, whether the function
        raised or returned something else: a refused success counts as a failure, and the
        motion keeps its fitness and measures; a refused fitness is NaN; a refused timestamp leaves
        its descriptors undefined, a refused quantity the one descriptor.

        Args:
            motions: Index in the batch and moments of every valid motion, each once.
            valid: (N,) bool, the motions that were neither rejected nor discarded.

        Returns:
            The values, without passive columns.

        Raises:
            FunctionalError: A valid motion is missing, another one is there, or one has no moments.
        """
        columns = _Columns.of(len(valid), fitness=self.fitness_names, measures=self.descriptors)
        refusals = Refusals()
        judged = np.zeros(len(valid), bool)
        # A value is judged by what it is: NumPy need not warn that a division made it NaN.
        with np.errstate(all="ignore"):
            for i, infos in motions:
                if not valid[i] or judged[i] or not infos:
                    raise FunctionalError(
                        f"Expected the moments of every valid motion once, but motion {i} has "
                        "none, comes twice or is not valid; pass each valid one once."
                    )
                judged[i] = True
                self._judge(i, infos, columns, refusals)
        if (judged != valid).any():
            raise FunctionalError(
                "Expected the moments of every valid motion, but motion "
                f"{int(np.argmax(judged != valid))} is missing; pass it too."
            )
        return Values(
            valid=valid,
            success=columns.success,
            fitness=columns.fitness,
            measures=columns.measures,
            refusals=refusals.listed(),
        )

    def _judge(self, i: int, infos: Infos, columns: "_Columns", refusals: "Refusals") -> None:
        try:
            columns.success[i] = call_success(self._functionals.success, infos)
        except RefusedValueError as refused:
            refusals.note(i, "success", "success", refused)
        self._rate(i, infos, columns, refusals)
        self._measure(i, infos, columns, refusals)

    def _rate(self, i: int, infos: Infos, columns: "_Columns", refusals: "Refusals") -> None:
        for name in self.fitness_names:
            try:
                columns.fitness[name][i] = call_fitness(self._functionals.fitness[name], infos)
            except RefusedValueError as refused:
                refusals.note(i, "fitness", name, refused)

    def _measure(self, i: int, infos: Infos, columns: "_Columns", refusals: "Refusals") -> None:
        measured: dict[tuple[int, str], tuple[float, ...] | None] = {}
        for h, timestamp in self._functionals.timestamps.items():
            try:
                moment = call_timestamp(timestamp, infos)
            except RefusedValueError as refused:
                refusals.note(i, "timestamp", h, refused)
                continue
            if moment is None:
                continue
            for g in self._lengths:
                key = (id(moment), g)
                if key not in measured:
                    measured[key] = self._quantity(i, g, moment, refusals)
                columns.measures[f"{h}.{g}"][i] = measured[key] or math.nan

    def _quantity(
        self, i: int, name: str, moment: Info, refusals: "Refusals"
    ) -> tuple[float, ...] | None:
        try:
            numbers = call_quantity(self._functionals.quantities[name], moment)
            if len(numbers) != self._lengths[name]:
                raise RefusedValueError(
                    f"returned {len(numbers)} numbers, not {self._lengths[name]} as on an example"
                )
        except RefusedValueError as refused:
            refusals.note(i, "quantity", name, refused)
            return None
        return numbers


def _call_on_moment(fitness: FitnessFunction, moment: Info) -> float:
    return call_fitness(fitness, [moment])


def _refuse_none(wanted: str, trial: Trial[Any]) -> None:
    if not trial.results:
        raise FunctionalError(
            f"Expected {wanted} on an example moment, but there is none: "
            f"{' '.join(trial.dropped)} Correct one, or add others."
        )


@dataclass(frozen=True, eq=False)
class _Columns:
    success: NDArray[np.bool_]
    fitness: dict[str, NDArray[np.float64]]
    measures: dict[str, NDArray[np.float64]]

    @classmethod
    def of(cls, n: int, *, fitness: Iterable[str], measures: Mapping[str, int]) -> "_Columns":
        return cls(
            success=np.zeros(n, bool),
            fitness={name: np.full(n, np.nan) for name in fitness},
            measures={name: np.full((n, length), np.nan) for name, length in measures.items()},
        )
