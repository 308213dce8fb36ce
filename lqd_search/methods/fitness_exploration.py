"""Algorithm 1: try each fitness in a short run, and go on with the one that did best."""

import copy
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from ribs.typing import FieldDesc

from lqd_search.archives.competition import Competition, compete_by_fitness
from lqd_search.archives.descriptor_ranges import DescriptorRanges, ObservationLog
from lqd_search.archives.multi_bd_archive import MultiBDArchive
from lqd_search.emitters.emitter import Emitter
from lqd_search.evaluation.values import Values
from lqd_search.methods.exploration_budget import ExplorationBudget
from lqd_search.methods.method import MethodError
from lqd_search.methods.turns import Turns
from lqd_search.schedulers.multi_bd_scheduler import MultiBDScheduler
from lqd_search.solution_space import SolutionSpace


class LanguageDrivenQD:
    """Algorithm 1 of the paper: multi-BD MAP-Elites Success after a fitness exploration.

    One short run per fitness, all from the same random first batch and none touching another. The
    fitness whose archive holds the most distinct successes, by the inferred condition, is kept; a
    tie goes to the earlier one. A run that holds no solution at all, since its fitness never gave
    a number, is kept only if they all are like that. Once, the descriptors' ranges are then
    learned again from everything evaluated so far, and its run goes on in the rebuilt archive
    until all evaluations are spent. It implements `Method`.

    Args:
        space: Where solutions come from.
        descriptors: For each descriptor, in order, its number of measures.
        fitness_names: The fitness functions to try, in order.
        evaluations: Number of evaluations to spend, exactly.
        batch_size: Number of solutions in a generation; the last one may be smaller.
        rng: Its children draw everything: one the first batch, one for each short run the rest.
        competition: The rule by which a cell is won; each short run has a copy of its own.
        emitter: Makes solutions of what an archive holds; each short run has a copy of its own.
            By default `MESEmitter(space)`.
        passive_fields: Passive or perceived columns to store with the elites, in pyribs' form.
        minimum: Number of defined values that a descriptor's range is learned from.
        cells: About as many cells each grid gets.

    Attributes:
        budget: How the evaluations are shared.
        exploration: For each fitness the distinct successes in its archive at the end of the
            exploration; empty before.
        chosen: The fitness that was kept; None before.

    Raises:
        BudgetError: The evaluations do not suffice for two generations per short run.
        MethodError: A fitness is named twice.
        ArchiveError: A descriptor has no measures, or a passive field has a name that is taken.
    """

    def __init__(
        self,
        space: SolutionSpace,
        *,
        descriptors: Mapping[str, int],
        fitness_names: Sequence[str],
        evaluations: int,
        batch_size: int,
        rng: np.random.Generator,
        competition: Competition = compete_by_fitness,
        emitter: Emitter | None = None,
        passive_fields: FieldDesc | None = None,
        minimum: int = 64,
        cells: int = 10_000,
    ) -> None:
        if len(set(fitness_names)) < len(fitness_names):
            raise MethodError(
                f"Expected fitness functions of different names, but got {', '.join(fitness_names)}"
                "; name each once."
            )
        self.budget = ExplorationBudget(evaluations, batch_size, len(fitness_names))
        self.exploration: dict[str, int] = {}
        self.chosen: str | None = None
        self._space = space
        self._ranges = DescriptorRanges(dict(descriptors), minimum=minimum, cells=cells)
        self._competition = competition
        self._emitter = emitter
        self._fields: FieldDesc = {"evaluation": ((), np.int64), **(passive_fields or {})}
        self._first_rng, *run_rngs = rng.spawn(1 + len(fitness_names))
        self._run_rngs = dict(zip(fitness_names, run_rngs, strict=True))
        self._turns = Turns(evaluations, batch_size)
        self._runs = self._new_runs()
        self._log: ObservationLog | None = ObservationLog(descriptors)

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
        """What the method is doing now, in a few words."""
        if self.evaluations == 0:
            return "first batch"
        if self.chosen is not None:
            return f"continuing with {self.chosen}"
        name = self._current.fitness
        return f"exploring {name} ({list(self._runs).index(name) + 1} of {len(self._runs)})"

    @property
    def archive(self) -> MultiBDArchive:
        """The archive of the run whose turn it is: a short run's, later that of the kept one."""
        return self._current.archive

    def output(self) -> Mapping[str, NDArray[Any]]:
        """Return the union of the archive's elites, as `MultiBDArchive.elites` does.

        Returns:
            For each field but the measures a column, in the order of the evaluations.
        """
        return self.archive.elites().fields

    def ask(self) -> NDArray[np.float64]:
        """Return the next generation.

        Returns:
            (n, dim) solutions, n being the batch size or what is left of the evaluations.

        Raises:
            MethodError: The generation before has not been told yet, or all is done.
        """
        n = self._turns.size()
        first = self.evaluations == 0
        return self._turns.ask(
            self._space.sample(n, rng=self._first_rng) if first else self._current.ask(n)
        )

    def tell(self, values: Values) -> None:
        """Take what the solutions asked for last came to.

        After an error nothing has changed, and it may be called again, unless it is one of the
        emitter's own: the archive has taken the solutions then, and another call is refused, but
        for the first generation and that at which the exploration ends.

        Args:
            values: As many as were asked for, with every fitness, descriptor and passive field.

        Raises:
            MethodError: Nothing was asked for.
            SchedulerError: Their number is another, a column is missing, or the emitter failed on
                them before.
            ArchiveError: A column does not fit the archive.
        """
        solutions = self._turns.asked()
        evaluation = self.evaluations + np.arange(len(solutions))
        if self._log is None:
            self._current.tell(solutions, values, evaluation=evaluation)
        elif self.evaluations + len(solutions) < self.budget.exploration:
            self._explore(solutions, values, evaluation, self._log)
        else:
            self._end_exploration(solutions, values, evaluation, self._log)
        self._turns.tell()

    @property
    def _current(self) -> MultiBDScheduler:
        turn = 0 if self.evaluations == 0 else self.budget.run_at(self.evaluations)
        # After the exploration only the kept run is left.
        return list(self._runs.values())[turn or 0]

    def _explore(
        self,
        solutions: NDArray[np.float64],
        values: Values,
        evaluation: NDArray[np.int64],
        log: ObservationLog,
    ) -> None:
        if self.evaluations == 0:
            runs = self._new_runs()
            for run in runs.values():
                run.inject(solutions, values, evaluation=evaluation)
            self._runs = runs
        else:
            self._current.tell(solutions, values, evaluation=evaluation)
        log.record(evaluation[values.valid], values.valid_measures)

    def _end_exploration(
        self,
        solutions: NDArray[np.float64],
        values: Values,
        evaluation: NDArray[np.int64],
        log: ObservationLog,
    ) -> None:
        # What is told here cannot be taken back out of a run, should the choice fail after it.
        current = self._current
        before = copy.deepcopy((current, log))
        complete = False
        try:
            self._explore(solutions, values, evaluation, log)
            self._choose(log)
            complete = True
        finally:
            if not complete:
                self._runs[current.fitness], self._log = before

    def _choose(self, log: ObservationLog) -> None:
        exploration = {name: run.archive.elites().successes for name, run in self._runs.items()}
        holding = [name for name, run in self._runs.items() if not run.empty]
        chosen = max(holding or exploration, key=exploration.__getitem__)
        run = self._runs[chosen]
        run.relearn_ranges(log)
        self.exploration, self.chosen = exploration, chosen
        self._runs, self._log = {chosen: run}, None

    def _new_runs(self) -> dict[str, MultiBDScheduler]:
        return {
            name: MultiBDScheduler(
                MultiBDArchive(
                    descriptors=self._ranges.descriptors,
                    solution_dim=self._space.dim,
                    extra_fields=self._fields,
                    # A competition may toss coins: copies keep the runs apart.
                    competition=copy.deepcopy(self._competition),
                    seed=0,
                ),
                self._space,
                ranges=self._ranges,
                fitness=name,
                batch_size=self.budget.batch_size,
                rng=rng,
                emitter=copy.deepcopy(self._emitter),
            )
            for name, rng in self._run_rngs.items()
        }
