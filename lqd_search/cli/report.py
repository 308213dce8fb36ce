"""`lqd report`: runs as one HTML file."""

from pathlib import Path

import click


@click.command("report")
@click.argument(
    "folders", metavar="DIR...", nargs=-1, required=True, type=click.Path(path_type=Path)
)
@click.option(
    "--out",
    type=click.Path(path_type=Path, dir_okay=False),
    help="The file to write (.html).  [default: report.html in the run's folder; of several runs, "
    "here]",
)
@click.option(
    "--rollouts",
    type=click.IntRange(min=0),
    default=12,
    show_default=True,
    help="Rollouts of each run that play in the page, at most.",
)
def report_command(*, folders: tuple[Path, ...], out: Path | None, rollouts: int) -> None:
    """Write one HTML file that shows the finished runs in DIR...

    The figures in one table, the curves in one plot, the heat maps of each grid, the functionals'
    source, and rollouts that play in the page: of well-spread cells of the ground-truth grid, the
    success of the highest fitness. The file needs neither a server nor a network. An earlier
    report of that name is replaced.
    """
    # What it needs takes a while to import, and no other command needs it.
    from lqd_search.report import (
        ReportedRun,
        check_report_path,
        labels_of,
        render_report,
        write_report,
    )

    runs = [
        ReportedRun.read(folder, label=label)
        for folder, label in zip(folders, labels_of(folders), strict=True)
    ]
    path = out or (folders[0] if len(runs) == 1 else Path()) / "report.html"
    check_report_path(path)
    write_report(path, render_report(runs, rollouts=rollouts))
    click.echo(f"report: {path}")
