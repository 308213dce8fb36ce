"""The progress of a benchmark: finished cells of all, and the time left."""

from types import TracebackType

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

from benchmarks.tables.cell_figures import CellFigures

# A cell of another method takes another time: only over many of them is the rate even.
_RATE_OVER = 3600.0


class CampaignProgress:
    """Shows how many cells are finished, and how much time is left at the rate so far.

    Time is reckoned in evaluations, those of the cells that are being run among them. Each
    finished cell is a line, so that a log without a terminal shows the same.

    Args:
        finished: Cells that are finished already.
        total: Cells in all.
        evaluations: Evaluations of a cell.
        begun: Evaluations that cells which go on have spent already.
        console: Where to show it; standard error by default.
    """

    def __init__(
        self,
        *,
        finished: int,
        total: int,
        evaluations: int,
        begun: int = 0,
        console: Console | None = None,
    ) -> None:
        self._finished, self._total, self._evaluations = finished, total, evaluations
        self._progress = Progress(
            TextColumn("{task.fields[cells]} cells"),
            BarColumn(),
            TaskProgressColumn(),
            TextColumn("time left"),
            TimeRemainingColumn(),
            console=console or Console(stderr=True),
            speed_estimate_period=_RATE_OVER,
        )
        self._bar = self._progress.add_task(
            "",
            total=total * evaluations,
            completed=finished * evaluations + begun,
            cells=self._cells,
        )

    def __enter__(self) -> "CampaignProgress":
        """Start drawing."""
        self._progress.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Stop drawing, and leave the last state on the screen."""
        self._progress.stop()

    def show_work(self, evaluations: int) -> None:
        """Show how many evaluations the cells that are being run have spent."""
        done = self._finished * self._evaluations + evaluations
        # Cells that go on one after another count from the start, or the rate would be too good.
        if done > self._progress.tasks[self._bar].completed:
            self._progress.update(self._bar, completed=done)

    def show_cell(self, figures: CellFigures) -> None:
        """Show that a cell is finished."""
        self._finished += 1
        self.show_work(0)
        self._progress.update(self._bar, cells=self._cells)
        self._progress.console.print(
            f"{figures.cell.name}: {figures.success_archive_size:,} successes, "
            f"{figures.ground_truth_cells:,} cells, {figures.seconds:,.0f} s; "
            f"{self._cells} cells, {self._left} left",
            highlight=False,
            markup=False,
            soft_wrap=True,
        )

    @property
    def finished(self) -> int:
        """How many cells are finished."""
        return self._finished

    @property
    def _cells(self) -> str:
        return f"{self._finished}/{self._total}"

    @property
    def _left(self) -> str:
        seconds = self._progress.tasks[self._bar].time_remaining
        if seconds is None:
            return "unknown time"
        hours, rest = divmod(int(seconds) // 60, 60)
        return f"{hours} h {rest:02} min"
