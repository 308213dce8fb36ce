"""The scheduler of the multi-BD search: an emitter's solutions go to every grid."""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from ribs.typing import BatchData

from lqd_envs.errors import LQDError
from lqd_search.archives.descriptor_ranges import DescriptorRanges, ObservationLog
from lqd_search.archives.multi_bd_archive import MultiBDArchive
from lqd_search.emitters.emitter import Emitter, Evaluated
from lqd_search.emitters.mes_emitter import MESEmitter
from lqd_search.evaluation.values import Values
from lqd_search.solution_space import SolutionSpace


class SchedulerError(LQDError):
    """The scheduler was called out of turn, or with what does not fit."""


class MultiBDScheduler:
    """Asks an emitter for solutions and offers every evaluated one to every grid.

    One run of multi-BD MAP-Elites Success with one fitness. A descriptor whose range is not known
    yet has no grid; its solutions are kept aside, and are offered to it, before the batch that
    made its range known, as soon as it is. The emitter is not shown the passive columns of the
    values. An error in `tell` or `inject` leaves all as it was before, unless it is one of the
    emitter's own: the archive has taken the batch then, and every further call is refused.

    Args:
        archive: Where the solutions go; it stores the extra field `evaluation`, and any other
            extra field is a passive or a perceived column of the values.
        space: Where solutions come from.
        ranges: What is known of the descriptors' ranges.
        fitness: Name of the fitness that is the objective.
        batch_size: Number of solutions in a generation.
        rng: Samples, selects and varies.
        emitter: Makes solutions of what the archive holds, for this scheduler alone; by default
            `MESEmitter(space)`.

    Attributes:
        archive: The archive; another one after `relearn_ranges`.
        ranges: What is known now of the descriptors' ranges.
        fitness: Name of the fitness.

    Raises:
        SchedulerError: The archive has no field `evaluation`, or other descriptors than `ranges`.
    """

    # For a scheduler of a checkpoint that was written before there was this attribute.
    _failed = False

    def __init__(
        self,
        archive: MultiBDArchive,
        space: SolutionSpace,
        *,
        ranges: DescriptorRanges,
        fitness: str,
        batch_size: int,
        rng: np.random.Generator,
        emitter: Emitter | None = None,
    ) -> None:
        if "evaluation" not in archive.field_list:
            raise SchedulerError(
                "Expected an archive with the extra field 'evaluation', but it has "
                f"{', '.join(archive.field_list)}; add it, with shape () and dtype int64."
            )
        if list(archive.descriptors.items()) != list(ranges.descriptors.items()):
            raise SchedulerError(
                f"Expected ranges of the archive's descriptors, {dict(archive.descriptors)}, but "
                f"got those of {dict(ranges.descriptors)}; pass the same to both."
            )
        self.archive = archive
        self.ranges = ranges
        self.fitness = fitness
        self._space = space
        self._batch_size = batch_size
        self._rng = rng
        self._emitter: Emitter = MESEmitter(space) if emitter is None else emitter
        self._asked: int | None = None
        self._emitted = False
        self._failed = False
        self._aside: dict[str, BatchData] = {}
        for name, spec in ranges.specs.items():
            if archive.specs.get(name) != spec:
                archive.set_grid(name, spec)

    @property
    def empty(self) -> bool:
        """Whether it holds no solution, neither in a grid nor kept aside."""
        aside = any(len(batch["solution"]) for batch in self._aside.values())
        return self.archive.empty and not aside

    def ask(self, n: int | None = None) -> NDArray[np.float64]:
        """Make the next generation.

        While every grid is empty it is uniformly random; otherwise the emitter makes it.

        Args:
            n: Number of solutions, if not the batch size.

        Returns:
            (n, dim) float64.

        Raises:
            SchedulerError: The generation before has not been told yet, the emitter failed on it,
                or n is negative.
        """
        self._refuse_after_failure()
        if self._asked is not None:
            raise SchedulerError(
                f"Expected the values of the {self._asked} solutions asked for last, but was asked "
                "for more; call tell first."
            )
        size = self._batch_size if n is None else n
        if size < 0:
            raise SchedulerError(
                f"Expected to be asked for 0 or more solutions, but got {size}; ask for more."
            )
        if self.archive.empty:
            solutions = self._space.sample(size, rng=self._rng)
        else:
            solutions = self._emitter.ask(size, archive=self.archive, rng=self._rng)
        self._asked, self._emitted = size, not self.archive.empty
        return solutions

    def tell(
        self,
        solutions: NDArray[np.float64],
        values: Values,
        *,
        evaluation: int | NDArray[np.integer],
    ) -> None:
        """Take what the solutions asked for came to, as `inject` takes it.

        Raises:
            SchedulerError: As from `inject`, or nothing was asked for, or another number of
                solutions.
            ArchiveError: As from `inject`.
        """
        self._refuse_after_failure()
        if self._asked is None:
            raise SchedulerError("Expected a call of ask before tell; to tell more, use inject.")
        if len(solutions) != self._asked:
            raise SchedulerError(
                f"Expected the {self._asked} solutions asked for, but got {len(solutions)}; tell "
                "all of them at once, in their order."
            )
        self._take(solutions, values, evaluation=np.asarray(evaluation), asked=self._emitted)
        self._asked, self._emitted = None, False

    def inject(
        self,
        solutions: NDArray[np.float64],
        values: Values,
        *,
        evaluation: int | NDArray[np.integer],
    ) -> None:
        """Take solutions that were not asked for, such as a first batch shared by several runs.

        Args:
            solutions: (N, dim) float64.
            values: What they came to, among it the scheduler's fitness and every descriptor.
            evaluation: Their (N,) ids, or the first of N successive ones.

        Raises:
            SchedulerError: Another number of values than of solutions, a column is missing, or the
                emitter failed on what was told before.
            ArchiveError: A column does not fit the archive.
        """
        self._refuse_after_failure()
        self._take(solutions, values, evaluation=np.asarray(evaluation), asked=False)

    def relearn_ranges(self, log: ObservationLog) -> None:
        """Learn the ranges again from everything observed, and rebuild the grids accordingly.

        The elites compete anew, in the order of their evaluation, for the cells of the new grids.

        Args:
            log: Has the measures of every elite.

        Raises:
            ObservationError: An elite's evaluation is not in the log.
        """
        ranges = self.ranges.relearn(log)
        archive = self.archive.emptied()
        for name, spec in ranges.specs.items():
            archive.set_grid(name, spec)
        elites = self.archive.elites().fields
        measures = log.measures(elites["evaluation"])
        # Whatever is defined for a descriptor that waited was kept aside, the elites included.
        measures |= {name: np.full_like(measures[name], np.nan) for name in self.ranges.waiting}
        aside = [self._aside[name] for name in self._aside if name in ranges.specs]
        archive.add(**_stack([*aside, {**elites, "measures": self._side_by_side(measures)}]))
        self.archive, self.ranges = archive, ranges
        self._aside = {name: self._aside[name] for name in ranges.waiting if name in self._aside}

    def _take(
        self,
        solutions: NDArray[np.float64],
        values: Values,
        *,
        evaluation: NDArray[np.integer],
        asked: bool,
    ) -> None:
        rows, batch = self._offerable(solutions, values, evaluation)
        ranges = self.ranges.observe(values.valid_measures)
        info = self._offer(batch, ranges)
        status, value = np.zeros(len(solutions), np.int32), np.full(len(solutions), -np.inf)
        # What was kept aside comes before the batch.
        status[rows] = info["status"][len(info["status"]) - len(rows) :]
        value[rows] = info["value"][len(info["value"]) - len(rows) :]
        told = Evaluated(
            solutions=solutions,
            values=replace(values, passive={}),
            objective=values.fitness[self.fitness],
            status=status,
            value=value,
            asked=asked,
        )
        # The archive has taken the batch, and what a failing emitter has learned is not known.
        self._failed = True
        self._emitter.tell(told, archive=self.archive)
        self._failed = False

    def _refuse_after_failure(self) -> None:
        if self._failed:
            raise SchedulerError(
                "Expected no further call, since the emitter failed on the last solutions, which "
                "the archive had taken already; go on from a checkpoint or a copy made before."
            )

    def _offer(self, batch: BatchData, ranges: DescriptorRanges) -> BatchData:
        learned = [name for name in self.ranges.waiting if name in ranges.specs]
        aside = {name: self._kept_aside(name, batch) for name in ranges.waiting}
        complete = False
        try:
            for name in learned:
                self.archive.set_grid(name, ranges.specs[name])
            early = [self._aside[name] for name in learned if name in self._aside]
            info = self.archive.add(**_stack([*early, batch]))
            complete = True
        finally:
            if not complete:
                for name in learned:
                    self.archive.drop_grid(name)
        self.ranges, self._aside = ranges, aside
        return info

    def _offerable(
        self, solutions: NDArray[np.float64], values: Values, evaluation: NDArray[np.integer]
    ) -> tuple[NDArray[np.intp], BatchData]:
        if len(values) != len(solutions):
            raise SchedulerError(
                f"Expected the values of {len(solutions)} solutions, but got {len(values)}; pass "
                "one for each."
            )
        passive = [name for name in self.archive.fields.extra if name != "evaluation"]
        stored = {**values.passive, **values.perceived}
        _check_names("fitness", [self.fitness], values.fitness)
        _check_names("measures", self.archive.descriptors, values.measures)
        _check_names("passive column", passive, stored)
        if evaluation.ndim == 0:
            evaluation = evaluation + np.arange(len(solutions))
        if evaluation.shape != (len(solutions),):
            raise SchedulerError(
                f"Expected one evaluation id, or {len(solutions)} of them, but got shape "
                f"{evaluation.shape}; pass the first one's alone, or one for each."
            )
        objective = values.fitness[self.fitness]
        rows = np.flatnonzero(values.valid & np.isfinite(objective))
        columns = {
            "solution": solutions[rows],
            "objective": objective[rows],
            "measures": self._side_by_side(values.measures)[rows],
            "success": values.success[rows],
            "evaluation": evaluation[rows],
        }
        return rows, self.archive.fields.check(
            columns | {name: stored[name][rows] for name in passive}
        )

    def _kept_aside(self, name: str, batch: BatchData) -> BatchData:
        block = self.archive.fields.columns_of(name)
        rows = ~np.isnan(batch["measures"][:, block.start])
        own = np.full_like(batch["measures"][rows], np.nan)
        own[:, block] = batch["measures"][rows, block]
        kept = {field: column[rows] for field, column in batch.items()} | {"measures": own}
        return _stack([self._aside[name], kept]) if name in self._aside else kept

    def _side_by_side(self, measures: Mapping[str, NDArray[np.float64]]) -> NDArray[np.float64]:
        for name, length in self.archive.descriptors.items():
            if measures[name].shape[1] != length:
                raise SchedulerError(
                    f"Expected {length} measures of descriptor {name!r}, but got "
                    f"{measures[name].shape[1]}; measure as many as the archive was made for."
                )
        return np.concatenate([measures[name] for name in self.archive.descriptors], axis=1)


def _stack(batches: list[BatchData]) -> BatchData:
    return {name: np.concatenate([batch[name] for batch in batches]) for name in batches[-1]}


def _check_names(kind: str, wanted: Iterable[str], there: Mapping[str, Any]) -> None:
    for name in wanted:
        if name not in there:
            raise SchedulerError(
                f"Expected the {kind} {name!r} among the values, but there are only "
                f"{', '.join(there) or 'none'}; let the evaluation give it too."
            )
