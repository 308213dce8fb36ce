"""The progress bar of a run."""

from types import TracebackType

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TextColumn,
    TimeRemainingColumn,
)

from lqd_search.metrics import Metrics
from lqd_search.values import Refusal


class RunProgress:
    """Shows evaluations, successes, coverage and evaluations per second on standard error.

    Args:
        title: What is searched for.
        total: Evaluations in all.
    """

    def __init__(self, title: str, *, total: int) -> None:
        self._console = Console(stderr=True)
        self._progress = Progress(
            TextColumn("{task.description}"),
            BarColumn(bar_width=24),
            MofNCompleteColumn(),
            TextColumn(
                "{task.fields[successes]:,} successes, coverage {task.fields[coverage]:.1%}, "
                "{task.fields[rate]:,.0f}/s"
            ),
            TimeRemainingColumn(compact=True),
            console=self._console,
        )
        self._console.print(title, highlight=False)
        self._bar = self._progress.add_task(
            "first batch", total=total, successes=0, coverage=0.0, rate=0.0
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
            coverage=metrics.coverage,
            rate=metrics.evaluations / metrics.seconds,
        )

    def warn(self, refusal: Refusal, motion: int) -> None:
        """Say that a functional's value was refused, the first time for this reason."""
        self._progress.console.print(
            f"note: the {refusal.kind} function {refusal.functional!r} {refusal.reason} for motion "
            f"{motion}; the run goes on without that value and counts such cases",
            highlight=False,
            markup=False,
        )
