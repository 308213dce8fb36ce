"""A generic genetic algorithm on one fitness, made of pymoo's operators."""

from collections.abc import Callable, Mapping
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pymoo.algorithms.soo.nonconvex.ga import FitnessSurvival, comp_by_cv_and_fitness
from pymoo.core.duplicate import DefaultDuplicateElimination
from pymoo.core.mating import Mating
from pymoo.core.population import Population
from pymoo.core.problem import Problem
from pymoo.core.repair import NoRepair, Repair
from pymoo.operators.crossover.sbx import SBX
from pymoo.operators.mutation.pm import PM
from pymoo.operators.selection.tournament import TournamentSelection
from ribs.typing import FieldDesc

from lqd_search.evaluation.values import Values
from lqd_search.methods.method import MethodError
from lqd_search.methods.told_columns import Told, ToldColumns, stack
from lqd_search.methods.turns import Turns
from lqd_search.solution_space import SolutionSpace

RepairFunction: TypeAlias = Callable[[NDArray[np.float64]], NDArray[np.float64]]
"""Brings (n, dim) solutions back into their space."""


class GeneticAlgorithm:
    """The single-objective genetic algorithm of pymoo, `GA`, with its default operators.

    Each generation binary tournaments choose the parents, simulated binary crossover and
    polynomial mutation make as many children, and the fittest of parents and children survive; a
    tie goes to the parents. Solutions that failed or whose fitness is undefined violate a
    constraint, so they are behind all others. The success condition plays no part.

    Children that equal one another or a parent are made again, as in pymoo; for 2,048 solutions
    this takes a tenth of a second and 70 MB, and saves about one evaluation in twenty. Where this
    does not yield enough children, random solutions fill up the generation.

    The mating and survival of pymoo are called on arrays and with `rng`, and nothing else of it is
    kept between generations. So a pickle holds arrays and a generator only, not pymoo's clocks,
    displays and functions. It implements `Method`.

    Args:
        space: Where the first solutions come from.
        fitness: Name of the fitness that is maximised.
        evaluations: Number of evaluations to spend, exactly.
        batch_size: Number of solutions in the population and in a generation; the last generation
            may be smaller.
        rng: Source of randomness.
        lower: (dim,), the least value of each number of a solution.
        upper: (dim,), the greatest one.
        repair: Brings the children, which lie between `lower` and `upper`, back into the space;
            None: they are in it. A function of a module is pickled by its name; the method of an
            object also puts `builtins.getattr` into the pickle.
        passive_fields: Passive columns to carry with the solutions, in pyribs' form.

    Raises:
        MethodError: There is no evaluation, a generation has fewer than two solutions, the bounds
            are none, or a passive field has a name that is taken.
    """

    def __init__(
        self,
        space: SolutionSpace,
        *,
        fitness: str,
        evaluations: int,
        batch_size: int,
        rng: np.random.Generator,
        lower: ArrayLike,
        upper: ArrayLike,
        repair: RepairFunction | None = None,
        passive_fields: FieldDesc | None = None,
    ) -> None:
        if evaluations < 1 or batch_size < 2:
            raise MethodError(
                "Expected at least 1 evaluation and a batch size of at least 2, but got "
                f"{evaluations} and {batch_size}; raise what is too low."
            )
        self._lower, self._upper = _bounds(lower, upper, dim=space.dim)
        self._space = space
        self._turns = Turns(evaluations, batch_size)
        self._rng = rng
        self._repair = repair
        self._columns = ToldColumns(space.dim, fitness, dict(passive_fields or {}))
        self._population = self._columns.none()

    @property
    def done(self) -> bool:
        """Whether all evaluations are spent."""
        return self._turns.done

    @property
    def evaluations(self) -> int:
        """Number of evaluations told so far."""
        return self._turns.evaluations

    @property
    def stage(self) -> str:
        """Which generation it is the turn of; after the last one, that one."""
        size = self._turns.batch_size
        generations = -(-self._turns.total // size)
        turn = min(self.evaluations // size + 1, generations)
        return f"generation {turn} of {generations}"

    @property
    def archive(self) -> None:
        """None: it has no archive."""
        return None

    @property
    def exploration(self) -> Mapping[str, int]:
        """Empty: it tries no fitness."""
        return {}

    @property
    def chosen(self) -> None:
        """None: it tries no fitness."""
        return None

    def output(self) -> Mapping[str, NDArray[Any]]:
        """Return the population without failed solutions, distinct, in the order of evaluation.

        Returns:
            The columns `solution`, `objective` (NaN where undefined), `success` and `evaluation`,
            and the passive fields.
        """
        return self._population.output()

    def ask(self) -> NDArray[np.float64]:
        """Return the next generation.

        Returns:
            (n, dim) solutions, n being the batch size or what is left of the evaluations.

        Raises:
            MethodError: The generation before has not been told yet, or all is done.
        """
        n = self._turns.size()
        return self._turns.ask(self._children(n) if self.evaluations else self._fresh(n))

    def tell(self, values: Values) -> None:
        """Take what the solutions asked for last came to.

        After an error nothing has changed, and it may be called again.

        Args:
            values: As many as were asked for, with the fitness and every passive field.

        Raises:
            MethodError: Nothing was asked for, their number is another, or a column is missing or
                of another form.
        """
        told = self._columns.take(
            self._turns.asked(), values, first_evaluation=self._turns.evaluations
        )
        together = stack([self._population, told])
        # pymoo, too, leaves the first generation in its order.
        if len(together) > self._turns.batch_size:
            together = together.rows(self._fittest(together))
        self._population = together
        self._turns.tell()

    def _children(self, n: int) -> NDArray[np.float64]:
        mating = Mating(
            TournamentSelection(func_comp=comp_by_cv_and_fitness),
            SBX(),
            PM(),
            repair=NoRepair() if self._repair is None else _Repair(self._repair),
            eliminate_duplicates=DefaultDuplicateElimination(),
        )
        parents = _individuals(self._population)
        children = mating.do(self._problem(), parents, n, random_state=self._rng)
        solutions = np.asarray(children.get("X"), np.float64).reshape(-1, self._space.dim)
        missing = n - len(solutions)
        return np.concatenate([solutions, self._fresh(missing)]) if missing else solutions

    def _fresh(self, n: int) -> NDArray[np.float64]:
        return self._space.sample(n, rng=self._rng)

    def _fittest(self, told: Told) -> NDArray[np.intp]:
        return np.array(
            FitnessSurvival().do(
                self._problem(),
                _individuals(told),
                n_survive=self._turns.batch_size,
                random_state=self._rng,
                return_indices=True,
            ),
            np.intp,
        )

    def _problem(self) -> Problem:
        return Problem(
            n_var=self._space.dim, n_obj=1, n_ieq_constr=1, xl=self._lower, xu=self._upper
        )


class _Repair(Repair):  # type: ignore[misc]  # pymoo has no types
    def __init__(self, function: RepairFunction) -> None:
        super().__init__()
        self._function = function

    def _do(
        self, _problem: Problem, solutions: NDArray[np.float64], **_: Any
    ) -> NDArray[np.float64]:
        return self._function(solutions)


def _individuals(told: Told) -> Population:
    """Return the solutions as pymoo has them: minimised, and 1 violates the constraint."""
    fitness = told.columns["objective"]
    unfit = ~told.valid | np.isnan(fitness)
    return Population.new(
        "X",
        told.columns["solution"],
        "F",
        np.where(unfit, 0.0, -fitness)[:, None],
        "G",
        unfit.astype(np.float64)[:, None],
    )


def _bounds(
    lower: ArrayLike, upper: ArrayLike, *, dim: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    bounds = np.array(lower, np.float64), np.array(upper, np.float64)
    fit = all(bound.shape == (dim,) and np.isfinite(bound).all() for bound in bounds)
    if not (fit and (bounds[0] <= bounds[1]).all()):
        raise MethodError(
            f"Expected {dim} finite lower bounds and as many upper ones, none below its lower one, "
            f"but got {bounds[0].tolist()} and {bounds[1].tolist()}; "
            "correct them."
        )
    return bounds
