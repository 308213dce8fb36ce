"""What the ablations run and compare, declared before any cell is run."""

from dataclasses import dataclass

from benchmarks.tables.cell import Cell
from benchmarks.tables.study import Study, compare_with_first
from benchmarks.tables.variants import OURS, VARIANTS

TASKS = ("faucet", "drawer")


@dataclass(frozen=True)
class Crossing:
    """Each recording with each seed, which tells the model's variance from the search's.

    Attributes:
        samples: The recordings.
        seeds: The seeds.
    """

    samples: tuple[int, ...]
    seeds: tuple[int, ...]

    def cells(self, task: str) -> list[Cell]:
        """Return the cells of `ours`, recording by recording."""
        return [Cell(task, OURS, seed, sample) for sample in self.samples for seed in self.seeds]


def _ablations(
    scale: str,
    *,
    evaluations: int,
    batch_size: int,
    seeds: tuple[int, ...],
    crossing: Crossing,
) -> Study:
    methods = tuple(VARIANTS)
    compared = [Cell.of(t, method, seed) for seed in seeds for t in TASKS for method in methods]
    crossed = [cell for task in TASKS for cell in crossing.cells(task)]
    return Study(
        title="Ablations of `ours`",
        scale=scale,
        evaluations=evaluations,
        batch_size=batch_size,
        tasks=TASKS,
        methods=methods,
        seeds=seeds,
        cells=tuple(dict.fromkeys([*compared, *crossed])),
        family=compare_with_first(TASKS, methods),
    )


CROSSINGS = {
    "smoke": Crossing(samples=(0, 1), seeds=(0, 1)),
    "small": Crossing(samples=(0, 1, 2, 3, 4), seeds=(0, 1, 2)),
}
"""The crossed cells at each scale."""

ABLATIONS = {
    "smoke": _ablations(
        "smoke", evaluations=320, batch_size=8, seeds=(0,), crossing=CROSSINGS["smoke"]
    ),
    "small": _ablations(
        "small",
        evaluations=20_480,
        batch_size=512,
        seeds=tuple(range(10)),
        crossing=CROSSINGS["small"],
    ),
}
"""The ablations at each scale."""
