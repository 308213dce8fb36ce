"""MAP-Elites Success with one fitness, on as many grids as there are descriptors."""

import copy
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray
from ribs.typing import FieldDesc

from lqd_search.archives.competition import Competition, compete_by_fitness
from lqd_search.archives.descriptor_ranges import DescriptorRanges, ObservationLog
from lqd_search.archives.grid_spec import GridSpec
from lqd_search.archives.multi_bd_archive import MultiBDArchive
from lqd_search.emitters.emitter import Emitter
from lqd_search.evaluation.values import Values
from lqd_search.methods.method import MethodError
from lqd_search.methods.turns import Turns
from lqd_search.schedulers.multi_bd_scheduler import MultiBDScheduler
from lqd_search.solution_space import SolutionSpace


class MapElitesSuccess:
    """MAP-Elites Success (MES) with one fitness and no exploration of others. A `Method`.

    With one descriptor it is the MES that the paper compares with: its "naive inference" where the
    language model wrote all three functions at once, and its handcrafted baseline where the
    descriptor's grid is given. With several it is the multi-BD search alone.

    The first batch is uniformly random. A descriptor without a given grid learns its range from the
    first values that it takes and, if `relearn_at` says so, once again from all it took.

    Args:
        space: Where solutions come from.
        descriptors: For each descriptor, in order, its number of measures.
        fitness: Name of the fitness that is the objective.
        evaluations: Number of evaluations to spend, exactly.
        batch_size: Number of solutions in a generation; the last one may be smaller.
        rng: Draws everything.
        grids: Grids that are given and not learned, by descriptor.
        relearn_at: Number of evaluations, at least 1; at the end of the generation in which it is
            reached the ranges are learned again and the grids rebuilt. None: never.
        competition: The rule by which a cell is won.
        emitter: Makes solutions of what the archive holds; the method has a copy of its own. By
            default `MESEmitter(space)`.
        passive_fields: Passive or perceived columns to store with the elites, in pyribs' form.
        minimum: Number of defined values that a descriptor's range is learned from.
        cells: About as many cells each learned grid gets.

    Attributes:
        exploration: Empty.
        chosen: None.

    Raises:
        MethodError: A number of evaluations or solutions is below 1, a given grid no descriptor's,
            or ranges shall be learned again although grids are given.
        ArchiveError: A descriptor has no measures, a given grid another number of dimensions, or a
            passive field a name that is taken.
    """

    def __init__(
        self,
        space: SolutionSpace,
        *,
        descriptors: Mapping[str, int],
        fitness: str,
        evaluations: int,
        batch_size: int,
        rng: np.random.Generator,
        grids: Mapping[str, GridSpec] | None = None,
        relearn_at: int | None = None,
        competition: Competition = compete_by_fitness,
        emitter: Emitter | None = None,
        passive_fields: FieldDesc | None = None,
        minimum: int = 64,
        cells: int = 10_000,
    ) -> None:
        if min(evaluations, batch_size, 1 if relearn_at is None else relearn_at) < 1:
            raise MethodError(
                "Expected at least 1 evaluation, 1 solution in a generation and 1 evaluation "
                f"before ranges are learned again, but got {evaluations}, {batch_size} and "
                f"{relearn_at}; raise what is too low."
            )
        if grids and (relearn_at is not None or not set(grids) <= set(descriptors)):
            raise MethodError(
                f"Expected given grids of the descriptors {', '.join(descriptors)} that are not "
                f"learned again, but got grids of {', '.join(grids)} and relearn_at={relearn_at}; "
                "leave one out."
            )
        self.exploration: dict[str, int] = {}
        self.chosen: str | None = None
        self._turns = Turns(evaluations, batch_size)
        self._relearn_at = relearn_at
        self._log = None if relearn_at is None else ObservationLog(descriptors)
        self._run = MultiBDScheduler(
            MultiBDArchive(
                descriptors=descriptors,
                solution_dim=space.dim,
                extra_fields={"evaluation": ((), np.int64), **(passive_fields or {})},
                competition=competition,
                seed=0,
            ),
            space,
            ranges=DescriptorRanges(
                dict(descriptors), minimum=minimum, cells=cells, specs=dict(grids or {})
            ),
            fitness=fitness,
            batch_size=batch_size,
            rng=rng,
            emitter=copy.deepcopy(emitter),
        )

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
        return "first batch" if self.evaluations == 0 else f"searching with {self._run.fitness}"

    @property
    def archive(self) -> MultiBDArchive:
        """The archive."""
        return self._run.archive

    def output(self) -> Mapping[str, NDArray[Any]]:
        """Return the union of the archive's elites, as `MultiBDArchive.elites` does."""
        return self.archive.elites().fields

    def ask(self) -> NDArray[np.float64]:
        """Return the next generation.

        Returns:
            (n, dim) solutions, n being the batch size or what is left of the evaluations.

        Raises:
            MethodError: The generation before has not been told yet, or all is done.
        """
        return self._turns.ask(self._run.ask(self._turns.size()))

    def tell(self, values: Values) -> None:
        """Take what the solutions asked for last came to.

        After an error nothing has changed, and it may be called again, unless it is one of the
        emitter's own: the archive has taken the solutions then, and another call is refused, but
        for that at which the ranges are learned again.

        Args:
            values: As many as were asked for, with the fitness, every descriptor and passive field.

        Raises:
            MethodError: Nothing was asked for.
            SchedulerError: Their number is another, a column is missing, or the emitter failed on
                them before.
            ArchiveError: A column does not fit the archive.
        """
        asked = self._turns.asked()
        evaluation = self.evaluations + np.arange(len(asked))
        if self._log is None or self._relearn_at is None:
            self._run.tell(asked, values, evaluation=evaluation)
        elif self.evaluations + len(asked) < self._relearn_at:
            self._tell_and_record(asked, values, evaluation, self._log)
        else:
            self._tell_and_relearn(asked, values, evaluation, self._log)
        self._turns.tell()

    def _tell_and_record(
        self,
        solutions: NDArray[np.float64],
        values: Values,
        evaluation: NDArray[np.int64],
        log: ObservationLog,
    ) -> None:
        self._run.tell(solutions, values, evaluation=evaluation)
        log.record(evaluation[values.valid], values.valid_measures)

    def _tell_and_relearn(
        self,
        solutions: NDArray[np.float64],
        values: Values,
        evaluation: NDArray[np.int64],
        log: ObservationLog,
    ) -> None:
        # What is told here cannot be taken back out of the run, should the learning fail after it.
        before = copy.deepcopy((self._run, log))
        complete = False
        try:
            self._tell_and_record(solutions, values, evaluation, log)
            self._run.relearn_ranges(log)
            self._log = None
            complete = True
        finally:
            if not complete:
                self._run, self._log = before
