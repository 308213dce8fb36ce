"""All judgements of a report, as its tables ask for them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from benchmarks.instances.figures import (
    Figure,
    by_size,
    fixed_motions,
    values_of,
    whole_archive,
)
from benchmarks.instances.judged_run import InstancesError, RunLabel
from benchmarks.instances.judgement import FilterFigures, Judgement
from benchmarks.instances.store import JudgementStore
from benchmarks.instances.two_way import Rate, mean_over_groups, two_way
from lqd_envs.instances import Instance

SEED = 20_260_103

Instances = Mapping[tuple[str, str], Sequence[Instance]]
"""The instances by task and kind."""


@dataclass(frozen=True)
class Results:
    """All judgements of a report.

    Attributes:
        instances: The instances by task and kind.
        judgements: What each run came to in each instance of its task, by the instance's name.
        cap: Most motions that were drawn for simulation.
        seed: Seed of the instances.
    """

    instances: Instances
    judgements: Mapping[RunLabel, Mapping[str, Judgement]]
    cap: int
    seed: int

    @classmethod
    def load(
        cls,
        store: JudgementStore,
        runs: Sequence[RunLabel],
        instances: Instances,
        *,
        seed: int,
    ) -> "Results":
        """Read the judgements of runs.

        Args:
            store: Where they are.
            runs: The runs.
            instances: The instances by task and kind.
            seed: Seed of the instances.

        Raises:
            InstancesError: One is missing or damaged.
        """
        judgements = {
            run: _judged(store, run, instances_of(instances, run.task)) for run in sorted(runs)
        }
        return cls(instances, judgements, store.cap, seed)

    @property
    def tasks(self) -> list[str]:
        """Ids of the tasks."""
        return list(dict.fromkeys(task for task, _ in self.instances))

    @property
    def kinds(self) -> list[str]:
        """Kinds of instances."""
        return list(dict.fromkeys(kind for _, kind in self.instances))

    def methods(self, task: str) -> list[str]:
        """Return the methods that there are runs of on a task."""
        return list(dict.fromkeys(run.method for run in self.judgements if run.task == task))

    def runs(self, task: str, method: str) -> list[RunLabel]:
        """Return the runs of a method on a task."""
        return [run for run in self.judgements if (run.task, run.method) == (task, method)]

    def solvable(self, task: str, kind: str) -> list[Instance]:
        """Return the instances that a motion of some run, whatever its method, solves."""
        runs = [run for run in self.judgements if run.task == task]
        return [
            instance
            for instance in self.instances[task, kind]
            if any(self.judgements[run][instance.name].solved for run in runs)
        ]

    def left_out(self, task: str, kind: str) -> list[Instance]:
        """Return the instances that no motion of any run solves."""
        kept = self.solvable(task, kind)
        return [instance for instance in self.instances[task, kind] if instance not in kept]

    def figures(self, task: str, kind: str, method: str, by: str) -> list[list[FilterFigures]]:
        """Return the figures of a filter, run by run and instance by instance."""
        names = [instance.name for instance in self.solvable(task, kind)]
        return [
            [self.judgements[run][name].filters[by] for name in names]
            for run in self.runs(task, method)
        ]

    def capped(self, task: str, kind: str, by: str, *, methods: Sequence[str]) -> bool:
        """Return whether some archive of these methods has motions that were not judged."""
        return any(
            one.capped
            for method in methods
            for row in self.figures(task, kind, method, by)
            for one in row
        )

    def rates(self, task: str, kind: str, method: str, by: str) -> Mapping[Figure, Rate]:
        """Return all rates of a method's archives; none where no instance is solvable.

        Those of subsets reach up to the largest archive of the method.
        """
        return self._rates[task, kind, method, by]

    def mean_rate(self, method: str, by: str, figure: Figure) -> Rate | None:
        """Return a method's mean over tasks and kinds; None where one of them does not have it."""
        groups = []
        for task in self.tasks:
            kinds = [kind for its_task, kind in self.instances if its_task == task]
            if method not in self.methods(task) or not all(
                figure in self.rates(task, kind, method, by) for kind in kinds
            ):
                return None
            groups.append(
                [_values(self.figures(task, kind, method, by), [figure])[0] for kind in kinds]
            )
        return mean_over_groups(groups, rng=np.random.default_rng(SEED))

    @property
    def different(self) -> int:
        """How many motions were not, bit for bit, what their run saw."""
        worst = (
            max((judgement.different for judgement in by_name.values()), default=0)
            for by_name in self.judgements.values()
        )
        return sum(worst)

    @cached_property
    def _rates(self) -> dict[tuple[str, str, str, str], dict[Figure, Rate]]:
        filters = next(
            (list(one.filters) for all_ in self.judgements.values() for one in all_.values()), []
        )
        return {
            (task, kind, method, by): self._rates_of(self.figures(task, kind, method, by))
            for task, kind in self.instances
            for method in self.methods(task)
            for by in filters
        }

    def _rates_of(self, figures: list[list[FilterFigures]]) -> dict[Figure, Rate]:
        if not figures[0]:
            return {}
        judged = max(one.judged for row in figures for one in row)
        wanted = [
            *whole_archive(),
            *by_size(judged=judged, cap=self.cap),
            *fixed_motions(instances=len(figures[0])),
        ]
        values = np.moveaxis(_values(figures, wanted), 0, -1)
        # The same draws for all, so that no rate depends on which others there are.
        rates = two_way(values, rng=np.random.default_rng(SEED))
        return dict(zip(wanted, rates, strict=True))


def instances_of(instances: Instances, task: str) -> list[Instance]:
    """Return the instances of a task, of all kinds."""
    return [one for (its_task, _), drawn in instances.items() if its_task == task for one in drawn]


def _values(
    figures: Sequence[Sequence[FilterFigures]], wanted: Sequence[Figure]
) -> NDArray[np.float64]:
    """Return (figures, runs, instances)."""
    return np.array([[values_of(figure, row) for row in figures] for figure in wanted])


def _judged(
    store: JudgementStore, run: RunLabel, instances: Sequence[Instance]
) -> dict[str, Judgement]:
    judged = store.load(run)
    for instance in instances:
        if instance.name not in judged:
            raise InstancesError(
                f"Expected what {run.name} came to in {instance.name} with a cap of {store.cap} "
                f"and all else as it is declared now, but it is not in {store.out}; name the "
                "run's folder, and it is judged."
            )
    return {instance.name: judged[instance.name] for instance in instances}
