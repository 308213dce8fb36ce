"""The progress bar of a run."""

from pathlib import Path
from types import TracebackType

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    ProgressColumn,
    TextColumn,
    TimeRemainingColumn,
)
from rich.table import Column

from lqd_search.evaluation.values import Refusal, StoppedFunction
from lqd_search.runs.metrics import Metrics

_BAR_WIDTH = 24
_WIDE_ENOUGH_FOR_A_BAR = 110


class RunProgress:
    """Shows evaluations, successes, coverage (where there are grids) and evaluations per second.

    In a line of 80 columns, which is also what is printed where there is no terminal, the figures
    come first: the stage is cut short, and there is no bar.

    Args:
        title: What is searched for.
        total: Evaluations in all.
        folder: The run's folder, which is named at the start: a run that is killed can be resumed.
        console: Where to show them; standard error by default.
    """

    def __init__(
        self, title: str, *, total: int, folder: Path, console: Console | None = None
    ) -> None:
        console = console or Console(stderr=True)
        self._progress = Progress(
            *_columns(total, width=console.width), console=console, expand=True
        )
        console.print(title, highlight=False, markup=False)
        console.print(f"Run folder: {folder}", highlight=False, markup=False, soft_wrap=True)
        self._bar = self._progress.add_task(
            "first batch", total=total, successes=0, coverage="", rate=0.0
        )

    def __enter__(self) -> "RunProgress":
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

    def show(self, metrics: Metrics) -> None:
        """Show where the run stands."""
        self._progress.update(
            self._bar,
            completed=metrics.evaluations,
            description=metrics.stage,
            successes=metrics.success_archive_size,
            coverage=_coverage(metrics),
            rate=metrics.evaluations / max(metrics.seconds, 1e-9),
        )

    def warn(self, refusal: Refusal, motion: int) -> None:
        """Say that a functional's value was refused, the first time for this reason."""
        self._progress.console.print(
            f"note: the {refusal.kind} function {refusal.functional!r} {refusal.reason} for motion "
            f"{motion}; the run goes on without that value and counts such cases",
            highlight=False,
            markup=False,
        )

    def warn_stopped(self, stopped: StoppedFunction) -> None:
        """Say that a functional was stopped."""
        self._progress.console.print(f"note: {stopped}", highlight=False, markup=False)


def _coverage(metrics: Metrics) -> str:
    return "" if metrics.coverage is None else f"coverage {metrics.coverage:.1%}, "


def _columns(total: int, *, width: int) -> list[ProgressColumn]:
    stage = Column(ratio=1, no_wrap=True, overflow="ellipsis")
    evaluations = Column(no_wrap=True, min_width=2 * len(str(total)) + 1)
    bar = [BarColumn(bar_width=_BAR_WIDTH)] if width >= _WIDE_ENOUGH_FOR_A_BAR else []
    return [
        TextColumn("{task.description}", table_column=stage),
        *bar,
        MofNCompleteColumn(table_column=evaluations),
        TextColumn(
            "{task.fields[successes]:,} successes, {task.fields[coverage]}"
            "{task.fields[rate]:,.0f}/s",
            table_column=Column(no_wrap=True),
        ),
        TimeRemainingColumn(compact=True),
    ]
