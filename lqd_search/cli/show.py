"""`lqd show`: the figures of a run."""

import json
from pathlib import Path

import click

from lqd_search.cli.table import print_summary
from lqd_search.runs.run_folder import RunFolder


@click.command("show")
@click.argument("folder", metavar="DIR", type=click.Path(path_type=Path))
@click.option("--json", "as_json", is_flag=True, help="Print JSON for scripts.")
def show_command(*, folder: Path, as_json: bool) -> None:
    """Show the figures of the run in DIR.

    Evaluations and what became of them, the success archive, the ground-truth cells, and each
    grid's coverage.
    """
    summary = RunFolder.open(folder).summary()
    if as_json:
        click.echo(json.dumps(summary, indent=2))
    else:
        print_summary(summary)
