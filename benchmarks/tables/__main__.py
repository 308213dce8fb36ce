"""Rebuild the paper's tables: `python -m benchmarks.tables`."""

import sys
from pathlib import Path
from shlex import join

import click

from benchmarks.tables.cell_process import run_command
from benchmarks.tables.cell_store import CellStore
from benchmarks.tables.command import (
    call,
    campaign_options,
    default_out,
    names,
    report,
    run_missing,
)
from benchmarks.tables.machine import usable_cpus
from benchmarks.tables.report import table_sections
from benchmarks.tables.study import METHODS, TABLES, TASKS


@click.command(name="tables")
@click.option(
    "--scale",
    type=click.Choice(tuple(TABLES)),
    default="smoke",
    show_default=True,
    help="How much to run: "
    + "; ".join(
        f"{name}, {study.evaluations:,} evaluations of {len(study.seeds)} "
        f"{'seed' if len(study.seeds) == 1 else 'seeds'}"
        for name, study in TABLES.items()
    )
    + ".",
)
@click.option(
    "--out",
    type=click.Path(path_type=Path, file_okay=False),
    help="Folder of the cells and the tables.  [default: benchmarks/results/tables/<scale>]",
)
@click.option("--methods", callback=names, help=f"Only these of {','.join(METHODS)}.")
@click.option("--tasks", callback=names, help=f"Only these of {','.join(TASKS)}.")
@campaign_options
def main(
    *,
    scale: str,
    out: Path | None,
    jobs: int | None,
    methods: list[str] | None,
    tasks: list[str] | None,
    seeds: list[int] | None,
    report_only: bool,
) -> None:
    """Run methods on tasks with seeds, and write the paper's tables from what is finished.

    Finished cells are kept in --out and not run again; one that was stopped goes on. Tables,
    comparisons and pictures are those of all cells that are finished, whichever were asked for.
    """
    study = TABLES[scale]
    store = CellStore(out or default_out("tables", scale), study.evaluations, study.batch_size)
    cells = study.chosen(tasks=tasks, methods=methods, seeds=seeds)
    status = 0
    if not report_only:
        again = join(["python", "-m", "benchmarks.tables", *sys.argv[1:]])
        command = run_command(evaluations=study.evaluations, batch_size=study.batch_size)
        status = run_missing(store, cells, command=command, jobs=jobs or usable_cpus(), again=again)
    report(store, study, sections=table_sections)
    sys.exit(status)


if __name__ == "__main__":
    call(main)
