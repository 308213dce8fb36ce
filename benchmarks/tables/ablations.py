"""Compare the variants of `ours` with it: `python -m benchmarks.tables.ablations`."""

import sys
from collections.abc import Mapping
from pathlib import Path
from shlex import join

import click

from benchmarks.tables.ablation_run import ablation_command
from benchmarks.tables.ablation_study import ABLATIONS, TASKS
from benchmarks.tables.cell_store import CellStore
from benchmarks.tables.command import (
    call,
    campaign_options,
    default_out,
    names,
    report,
    run_missing,
)
from benchmarks.tables.comparison_table import comparison_section
from benchmarks.tables.machine import usable_cpus
from benchmarks.tables.markdown import markdown_table
from benchmarks.tables.report import task_sections
from benchmarks.tables.results import Results
from benchmarks.tables.task_tables import variant_table
from benchmarks.tables.variance_table import variance_table
from benchmarks.tables.variants import VARIANTS


def ablation_sections(results: Results) -> Mapping[str, str]:
    """Return the sections of the ablations' report."""
    summaries = [(variant.name, variant.summary) for variant in VARIANTS.values()]
    sections = {"The variants": markdown_table(("variant", "what it is"), summaries, words=2)}
    for task in results.study.tasks:
        sections.update(task_sections(results, task, final=variant_table(results, task)))
    return {
        **sections,
        "Comparisons": comparison_section(results),
        "The model's variance and the search's": variance_table(results),
    }


def take_over(store: CellStore, tables: Path, *, scale: str) -> int:
    """Keep the cells of `ours` that the tables at the same scale have finished.

    Returns:
        How many.
    """
    cells = ABLATIONS[scale].cells
    store.prepare()
    there, here = (
        CellStore(tables, store.evaluations, store.batch_size).load(cells),
        store.load(cells),
    )
    new = [figures for cell, figures in there.items() if cell not in here]
    for figures in new:
        store.keep(figures)
    return len(new)


@click.command(name="ablations")
@click.option(
    "--scale",
    type=click.Choice(tuple(ABLATIONS)),
    default="smoke",
    show_default=True,
    help="How much to run: "
    + "; ".join(
        f"{name}, {len(study.cells)} cells of {study.evaluations:,} evaluations"
        for name, study in ABLATIONS.items()
    )
    + ".",
)
@click.option(
    "--out",
    type=click.Path(path_type=Path, file_okay=False),
    help="Folder of the cells and the tables.  [default: benchmarks/results/ablations/<scale>]",
)
@click.option(
    "--tables",
    type=click.Path(path_type=Path, file_okay=False, exists=True),
    help="Folder of the tables at the same scale: their cells of ours are taken, not run again.",
)
@click.option("--variants", callback=names, help=f"Only these of {','.join(VARIANTS)}.")
@click.option("--tasks", callback=names, help=f"Only these of {','.join(TASKS)}.")
@campaign_options
def main(
    *,
    scale: str,
    out: Path | None,
    jobs: int | None,
    tables: Path | None,
    variants: list[str] | None,
    tasks: list[str] | None,
    seeds: list[int] | None,
    report_only: bool,
) -> None:
    """Run variants of `ours` on two tasks, and write what each of its parts is worth.

    Finished cells are kept in --out and not run again; one that was stopped goes on.
    """
    study = ABLATIONS[scale]
    store = CellStore(out or default_out("ablations", scale), study.evaluations, study.batch_size)
    cells = study.chosen(tasks=tasks, methods=variants, seeds=seeds)
    if tables is not None:
        click.echo(f"{take_over(store, tables, scale=scale)} cells taken from {tables}", err=True)
    status = 0
    if not report_only:
        again = join(["python", "-m", "benchmarks.tables.ablations", *sys.argv[1:]])
        command = ablation_command(evaluations=study.evaluations, batch_size=study.batch_size)
        status = run_missing(store, cells, command=command, jobs=jobs or usable_cpus(), again=again)
    report(store, study, sections=ablation_sections)
    sys.exit(status)


if __name__ == "__main__":
    call(main)
