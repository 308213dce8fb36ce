"""What a benchmark runs and compares, declared before any cell is run."""

from collections.abc import Sequence
from dataclasses import dataclass

from benchmarks.tables.cell import Cell
from benchmarks.tables.comparison import Hypothesis
from benchmarks.tables.measures import COMPARED
from lqd_envs import LQDError

TASKS = ("grasp", "faucet", "drawer", "push")
METHODS = ("ours", "direct", "handcrafted", "ga", "random", "ours_plus")
# Where the budget does not suffice for all tasks, these are complete first.
_FIRST = ("drawer", "grasp")


class StudyError(LQDError):
    """A benchmark is asked for what it does not declare."""


@dataclass(frozen=True)
class Study:
    """What a benchmark runs and compares.

    Attributes:
        title: Heading of its report.
        scale: Name of the scale.
        evaluations: Evaluations of each cell.
        batch_size: Solutions in a generation of each cell.
        tasks: In the order of the report.
        methods: In the order of the report, the one that all others are compared with first.
        seeds: Of each method on each task.
        cells: All cells, in the order in which they are run.
        family: The comparisons, which are corrected for together.
    """

    title: str
    scale: str
    evaluations: int
    batch_size: int
    tasks: tuple[str, ...]
    methods: tuple[str, ...]
    seeds: tuple[int, ...]
    cells: tuple[Cell, ...]
    family: tuple[Hypothesis, ...]

    def chosen(
        self,
        *,
        tasks: Sequence[str] | None,
        methods: Sequence[str] | None,
        seeds: Sequence[int] | None,
    ) -> list[Cell]:
        """Return some of the cells, in order.

        Args:
            tasks: Of these tasks; None: of all.
            methods: Of these methods; None: of all.
            seeds: Of these seeds; None: of all.

        Raises:
            StudyError: One of them is not declared at this scale.
        """
        _check(tasks, [cell.task for cell in self.cells])
        _check(methods, [cell.method for cell in self.cells])
        _check(seeds, [cell.seed for cell in self.cells])
        return [
            cell
            for cell in self.cells
            if (tasks is None or cell.task in tasks)
            and (methods is None or cell.method in methods)
            and (seeds is None or cell.seed in seeds)
        ]

    def group(self, task: str, method: str) -> list[Cell]:
        """Return the cells of a method on a task that its tables and comparisons rest on."""
        return [Cell.of(task, method, seed) for seed in self.seeds]

    def compares(self, cell: Cell) -> bool:
        """Return whether its tables and comparisons rest on a cell; others cross recordings."""
        return cell in self.group(cell.task, cell.method)


def compare_with_first(tasks: Sequence[str], methods: Sequence[str]) -> tuple[Hypothesis, ...]:
    """Declare the comparisons of the first method with each other, by task and measure."""
    first, *others = methods
    return tuple(
        Hypothesis(task, measure.name, first, other)
        for task in tasks
        for measure in COMPARED
        for other in others
    )


def _tables(scale: str, *, evaluations: int, batch_size: int, seeds: tuple[int, ...]) -> Study:
    rest = tuple(task for task in TASKS if task not in _FIRST)
    # Seed by seed, so that what there is when the time is over is as even as it can be.
    cells = tuple(
        Cell.of(task, method, seed)
        for wave in ((_FIRST, rest) if scale == "paper" else (TASKS,))
        for seed in seeds
        for task in wave
        for method in METHODS
    )
    return Study(
        title="The paper's tables",
        scale=scale,
        evaluations=evaluations,
        batch_size=batch_size,
        tasks=TASKS,
        methods=METHODS,
        seeds=seeds,
        cells=cells,
        family=compare_with_first(TASKS, METHODS),
    )


TABLES = {
    "smoke": _tables("smoke", evaluations=320, batch_size=8, seeds=(0,)),
    "small": _tables("small", evaluations=20_480, batch_size=512, seeds=tuple(range(10))),
    "paper": _tables("paper", evaluations=102_400, batch_size=2_048, seeds=tuple(range(5))),
}
"""The tables at each scale."""


def _check(
    given: Sequence[str] | Sequence[int] | None, known: Sequence[str] | Sequence[int]
) -> None:
    unknown = [one for one in given or () if one not in known]
    if unknown:
        names = ", ".join(map(str, dict.fromkeys(known)))
        raise StudyError(
            f"Expected some of {names}, which are declared at this scale, but got "
            f"{', '.join(map(str, unknown))}; leave it out."
        )
