"""What the commands of the benchmarks share: running what is missing, then the report."""

import signal
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NoReturn

import click

from benchmarks.tables.campaign import Campaign, Outcome
from benchmarks.tables.campaign_progress import CampaignProgress
from benchmarks.tables.cell import Cell
from benchmarks.tables.cell_process import CellCommand, spent
from benchmarks.tables.cell_store import CellStore
from benchmarks.tables.report import Sections, write_report
from benchmarks.tables.results import Results
from benchmarks.tables.study import Study
from lqd_envs import LQDError

_FAILED = 1
_BAD_INPUT = 2
_LONGEST_SAID = 500
_INTERRUPTED = 130


def names(_: click.Context, __: click.Parameter, value: str | None) -> list[str] | None:
    """Read names that are separated by commas."""
    return None if value is None else [name.strip() for name in value.split(",")]


def seeds(_: click.Context, __: click.Parameter, value: str | None) -> list[int] | None:
    """Read seeds that are separated by commas, and ranges of them such as 0-4."""
    if value is None:
        return None
    found: list[int] = []
    for part in value.split(","):
        ends = [end.strip() for end in part.split("-")]
        numbers = [int(end) for end in ends if end.isdecimal()]
        if len(numbers) != len(ends) or len(ends) > 2 or numbers[0] > numbers[-1]:
            raise click.BadParameter(f"expected seeds such as 0,3 or 0-4, but got {value!r}")
        found += range(numbers[0], numbers[-1] + 1)
    return found


_CAMPAIGN_OPTIONS = (
    click.option(
        "--jobs",
        type=click.IntRange(min=1),
        help="Cells that are run at the same time, each on one thread.  [default: one for each "
        "CPU]",
    ),
    click.option(
        "--seeds",
        callback=seeds,
        help="Only these of the scale's seeds, such as 0,3 or 0-4.",
    ),
    click.option("--report", "report_only", is_flag=True, help="Run nothing, write the tables."),
)


def campaign_options(command: Callable[..., None]) -> Callable[..., None]:
    """Add the options that say which cells are run, and how: `jobs`, `seeds`, `report_only`."""
    for option in reversed(_CAMPAIGN_OPTIONS):
        command = option(command)
    return command


def call(command: click.Command) -> None:
    """Call a benchmark's command; bad input is one sentence, and exit status 2."""
    try:
        command()
    except LQDError as error:
        click.echo(f"{command.name}: {error}", err=True)
        sys.exit(_BAD_INPUT)


def end_politely() -> None:
    """Let SIGTERM do what Ctrl-C does: what was started is ended, and it is said how to go on."""
    signal.signal(signal.SIGTERM, signal.default_int_handler)


def stopped(what: str, *, again: str) -> NoReturn:
    """End the process that a user stopped, and say how to go on.

    Args:
        what: What there is by now.
        again: The command that goes on.
    """
    # With hundreds of runs on it nobody would read what stands before.
    how = f"go on with `{again}`" if len(again) <= _LONGEST_SAID else "the same command goes on"
    click.echo(f"stopped; {what}: {how}", err=True)
    sys.exit(_INTERRUPTED)


def run_missing(
    store: CellStore, cells: Sequence[Cell], *, command: CellCommand, jobs: int, again: str
) -> int:
    """Run the cells that are not finished, and say what became of them.

    Where it is interrupted it ends the process.

    Args:
        store: Where the cells are kept.
        cells: Those that are asked for.
        command: How to run a cell.
        jobs: How many at a time.
        again: The command that goes on.

    Returns:
        The exit status: 0, or another one where a cell has no result.
    """
    finished = store.load(cells)
    missing = [cell for cell in cells if cell not in finished]
    end_politely()
    progress = CampaignProgress(
        finished=len(finished),
        total=len(cells),
        evaluations=store.evaluations,
        begun=sum(spent(store.run_folder(cell)) for cell in missing),
    )
    campaign = Campaign(store, command=command, jobs=jobs)
    try:
        with progress:
            outcome = campaign.run(missing, on_work=progress.show_work, on_cell=progress.show_cell)
    except KeyboardInterrupt:
        stopped(
            f"{progress.finished} of {len(cells)} cells are finished, and those under way go on "
            "where they were",
            again=again,
        )
    return _say(outcome, again=again)


def report(store: CellStore, study: Study, *, sections: Sections) -> None:
    """Write the report of the finished cells, and say where."""
    results = Results(study, store.load(study.cells))
    for path in write_report(store.out, results, sections=sections)[:2]:
        click.echo(str(path))


def default_out(study: str, scale: str) -> Path:
    """Return where a benchmark's results are, if nothing else is said."""
    return Path("benchmarks") / "results" / study / scale


def _say(outcome: Outcome, *, again: str) -> int:
    for cell in outcome.elsewhere:
        click.echo(f"note: another process is running {cell.name}; it is left to it", err=True)
    for cell, why in outcome.failed.items():
        click.echo(f"{cell.name} has no result: {why}", err=True)
    if outcome.failed:
        click.echo(f"try again with `{again}`", err=True)
    return _FAILED if outcome.failed or outcome.elsewhere else 0
