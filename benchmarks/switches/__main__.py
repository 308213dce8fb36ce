"""`python -m benchmarks.switches`: what each switch of `ours_plus` gains on its own."""

import json
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import asdict
from functools import partial
from pathlib import Path

import click

from benchmarks.switches.gain import TASKS, TUNING_SEEDS, given_up, table
from benchmarks.switches.kept_cells import SwitchesError, load
from benchmarks.switches.switch_cell import OURS, SwitchCell, run_cell
from benchmarks.tables.command import call
from lqd_envs.atomic_file import write_atomically
from lqd_search.methods.plus_switches import Switch


def _missing(task: str, names: Sequence[str], cells: Sequence[SwitchCell]) -> list[tuple[str, int]]:
    done = {(cell.task, cell.switches, cell.seed) for cell in cells}
    return [
        (name, seed)
        for name in names
        if not given_up(name, cells)
        for seed in TUNING_SEEDS
        if (task, name, seed) not in done
    ]


def _known(_: click.Context, __: click.Parameter, value: str | None) -> str | None:
    for name in value.split("+") if value is not None else ():
        if name not in list(Switch):
            raise SwitchesError(
                f"Expected switches among {', '.join(Switch)}, joined by +, but got {name!r}."
            )
    return value


def _run_and_keep(
    out: Path, *, task: str, name: str, seed: int, evaluations: int, batch_size: int
) -> Path:
    switches = [] if name == OURS else [Switch(part) for part in name.split("+")]
    cell = run_cell(task, switches, seed=seed, evaluations=evaluations, batch_size=batch_size)
    path = out / f"{task}.{name}.{seed}.json"
    write_atomically(path, (json.dumps(asdict(cell), indent=2) + "\n").encode())
    return path


@click.command(name="switches")
@click.option("--out", type=click.Path(path_type=Path), required=True, help="Folder of the cells.")
@click.option("--evaluations", type=int, default=20_480, show_default=True)
@click.option("--batch-size", type=int, default=512, show_default=True)
@click.option("--jobs", type=int, default=2, show_default=True, help="Runs at the same time.")
@click.option(
    "--combined",
    callback=_known,
    help="Switches joined by +, to be run together instead of each alone.",
)
@click.option("--table", "table_only", is_flag=True, help="Run nothing, print the table.")
def main(
    *,
    out: Path,
    evaluations: int,
    batch_size: int,
    jobs: int,
    combined: str | None,
    table_only: bool,
) -> None:
    """Measure what each switch of `ours_plus` gains on its own, on the tuning seeds.

    Finished cells are kept in --out and not run again. A switch that failed to pay on two of the
    four tasks cannot pay on three any more, and is given up.
    """
    out.mkdir(parents=True, exist_ok=True)
    kept = partial(load, out, evaluations=evaluations, batch_size=batch_size)
    names = [OURS, combined] if combined else [OURS, *Switch]
    for task in () if table_only else TASKS:
        with ProcessPoolExecutor(jobs) as pool:
            futures = [
                pool.submit(
                    _run_and_keep,
                    out,
                    task=task,
                    name=name,
                    seed=seed,
                    evaluations=evaluations,
                    batch_size=batch_size,
                )
                for name, seed in _missing(task, names, kept())
            ]
            for future in as_completed(futures):
                click.echo(future.result(), err=True)
    click.echo(table(kept()))


if __name__ == "__main__":
    call(main)
