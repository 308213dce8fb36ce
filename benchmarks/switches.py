"""What each switch of `ours_plus` gains: `python -m benchmarks.switches --out DIR`."""

import json
import time
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import asdict, dataclass
from pathlib import Path

import click
import numpy as np

from benchmarks.recorded_recipe import recorded_recipe
from lqd_envs import get_task
from lqd_envs.atomic_file import write_atomically
from lqd_search.loop import search
from lqd_search.methods.by_name import Setting, ours_with
from lqd_search.methods.plus_switches import Switch
from lqd_search.runs.success_archive import SuccessArchive

# Never those of the benchmarks, which begin at 0; seed k uses the recorded sample k mod 5.
TUNING_SEEDS = (100, 101, 102, 103, 104)
_SAMPLES = 5
_TASKS = ("faucet", "drawer", "push", "grasp")
_PAYING_TASKS = 3
_OURS = "ours"


@dataclass(frozen=True)
class Cell:
    """One run of `ours` with some switches.

    Attributes:
        task: Short name of the task.
        switches: Names of the switches that are on, joined by `+`; `ours` for none.
        seed: Seed of the search.
        evaluations: Evaluations spent.
        batch_size: Solutions in a generation.
        success_archive_size: Elites that the expert's condition approves.
        ground_truth_cells: Cells of the ground-truth grid that these fill.
        archive_size: Distinct elites.
        valid: Motions that were judged.
        seconds: How long it took.
    """

    task: str
    switches: str
    seed: int
    evaluations: int
    batch_size: int
    success_archive_size: int
    ground_truth_cells: int
    archive_size: int
    valid: int
    seconds: float


def run_cell(
    task_name: str, switches: Sequence[Switch], *, seed: int, evaluations: int, batch_size: int
) -> Cell:
    """Run `ours` with some switches on, and judge its archive."""
    task = get_task(f"LQD/{task_name.capitalize()}-v0")
    recipe = recorded_recipe(task, method="ours_plus", sample=seed % _SAMPLES, threads=1)
    valid: list[int] = []
    began = time.monotonic()
    with recipe.opened() as evaluate:
        setting = Setting(
            task=task,
            judge=evaluate.judge,
            evaluations=evaluations,
            batch_size=batch_size,
            rng=np.random.default_rng(seed),
        )
        method = ours_with(setting, switches=switches)
        search(method, evaluate, observe=lambda told: valid.append(int(told.values.valid.sum())))
    archive = SuccessArchive.of(method.output(), ground_truth=task.ground_truth)
    return Cell(
        task=task_name,
        switches="+".join(switches) or _OURS,
        seed=seed,
        evaluations=evaluations,
        batch_size=batch_size,
        success_archive_size=archive.size,
        ground_truth_cells=len(archive.cells),
        archive_size=archive.elites,
        valid=sum(valid),
        seconds=time.monotonic() - began,
    )


@dataclass(frozen=True)
class Gain:
    """How a switch did on one task beside `ours`, seed by seed.

    Attributes:
        task: Short name of the task.
        switches: Names of the switches.
        size: For each seed the ratio of the success archives' sizes, each plus 1.
        cells: For each seed the same ratio of their ground-truth cells.
    """

    task: str
    switches: str
    size: tuple[float, ...]
    cells: tuple[float, ...]

    @property
    def pays(self) -> bool:
        """Whether it counts as a gain, by the rule that was fixed before any cell was run.

        The median of one ratio is at least 1.05, and that of the other at least 0.95.
        """
        size, cells = np.median(self.size), np.median(self.cells)
        return bool(max(size, cells) >= 1.05 and min(size, cells) >= 0.95)


def gains(cells: Sequence[Cell]) -> list[Gain]:
    """Compare each complete set of seeds with that of `ours` on the same task."""
    by_key = {(c.task, c.switches, c.seed): c for c in cells}
    found = []
    for task, switches in sorted({(c.task, c.switches) for c in cells if c.switches != _OURS}):
        pairs = [
            (by_key.get((task, switches, seed)), by_key.get((task, _OURS, seed)))
            for seed in TUNING_SEEDS
        ]
        complete = [(a, b) for a, b in pairs if a and b]
        if len(complete) == len(TUNING_SEEDS):
            found.append(
                Gain(
                    task,
                    switches,
                    tuple(
                        (a.success_archive_size + 1) / (b.success_archive_size + 1)
                        for a, b in complete
                    ),
                    tuple(
                        (a.ground_truth_cells + 1) / (b.ground_truth_cells + 1) for a, b in complete
                    ),
                )
            )
    return found


def table(cells: Sequence[Cell]) -> str:
    """Return the gains as a Markdown table: medians, and interquartile ranges in brackets."""
    lines = [
        "| switch | task | success archive, ratio | ground-truth cells, ratio | pays |",
        "|---|---|---:|---:|---|",
    ]
    lines += [
        f"| {gain.switches} | {gain.task} | {_spread(gain.size)} | {_spread(gain.cells)} | "
        f"{'yes' if gain.pays else 'no'} |"
        for gain in gains(cells)
    ]
    return "\n".join(lines)


def _spread(ratios: Sequence[float]) -> str:
    low, median, high = np.percentile(ratios, [25, 50, 75])
    return f"{median:.2f} [{low:.2f}, {high:.2f}]"


def _given_up(name: str, cells: Sequence[Cell]) -> bool:
    """Return whether a switch cannot pay on three tasks any more, so that more runs are idle."""
    lost = sum(not gain.pays for gain in gains(cells) if gain.switches == name)
    return lost > len(_TASKS) - _PAYING_TASKS


def _missing(task: str, names: Sequence[str], cells: Sequence[Cell]) -> list[tuple[str, int]]:
    done = {(cell.task, cell.switches, cell.seed) for cell in cells}
    return [
        (name, seed)
        for name in names
        if not _given_up(name, cells)
        for seed in TUNING_SEEDS
        if (task, name, seed) not in done
    ]


def _load(out: Path) -> list[Cell]:
    return [Cell(**json.loads(path.read_text())) for path in sorted(out.glob("*.json"))]


def _run_and_keep(
    out: Path, *, task: str, name: str, seed: int, evaluations: int, batch_size: int
) -> Path:
    switches = [] if name == _OURS else [Switch(part) for part in name.split("+")]
    cell = run_cell(task, switches, seed=seed, evaluations=evaluations, batch_size=batch_size)
    path = out / f"{task}.{name}.{seed}.json"
    write_atomically(path, (json.dumps(asdict(cell), indent=2) + "\n").encode())
    return path


@click.command()
@click.option("--out", type=click.Path(path_type=Path), required=True, help="Folder of the cells.")
@click.option("--evaluations", type=int, default=20_480, show_default=True)
@click.option("--batch-size", type=int, default=512, show_default=True)
@click.option("--jobs", type=int, default=2, show_default=True, help="Runs at the same time.")
@click.option("--combined", help="Switches joined by +, to be run together instead of each alone.")
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
    names = [_OURS, combined] if combined else [_OURS, *Switch]
    for task in () if table_only else _TASKS:
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
                for name, seed in _missing(task, names, _load(out))
            ]
            for future in as_completed(futures):
                click.echo(future.result(), err=True)
    click.echo(table(_load(out)))


if __name__ == "__main__":
    main()
