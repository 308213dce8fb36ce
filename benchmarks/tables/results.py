"""The finished cells of a study, as its report asks for them."""

from collections.abc import Mapping
from dataclasses import dataclass

from benchmarks.tables.cell import Cell
from benchmarks.tables.cell_figures import CellFigures
from benchmarks.tables.comparison import Comparison, compare
from benchmarks.tables.measures import BY_NAME, Measure
from benchmarks.tables.spread import Spread
from benchmarks.tables.study import Study


@dataclass(frozen=True)
class Results:
    """The finished cells of a study.

    Attributes:
        study: What was to be run.
        cells: Figures of the cells that are finished.
    """

    study: Study
    cells: Mapping[Cell, CellFigures]

    def group(self, task: str, method: str) -> list[CellFigures]:
        """Return the finished cells of a method on a task, seed by seed."""
        return [self.cells[c] for c in self.study.group(task, method) if c in self.cells]

    def begun(self, task: str) -> bool:
        """Return whether any cell of a task is finished."""
        return any(cell.task == task for cell in self.cells)

    def spread(self, task: str, method: str, measure: Measure) -> Spread | None:
        """Return how a measure spreads over the finished seeds; None: there is no value."""
        return Spread.of(measure.of(cell) for cell in self.group(task, method))

    def complete_values(self, task: str, method: str, measure: str) -> list[float] | None:
        """Return a measure of every seed that was declared; None: one is not finished."""
        cells = self.group(task, method)
        if len(cells) < len(self.study.seeds):
            return None
        return [BY_NAME[measure].of(cell) for cell in cells]

    def comparisons(self) -> list[Comparison]:
        """Return those of the declared comparisons whose cells are all finished."""
        return compare(self.study.family, self.complete_values)
