"""Judge archives by task instances: `python -m benchmarks.instances RUN...`."""

import sys
from collections.abc import Sequence
from pathlib import Path
from shlex import join

import click
from rich.console import Console
from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

from benchmarks.instances.declared import INSTANCE_SEED
from benchmarks.instances.judged_run import InstancesError, JudgedRun, RunLabel, check_labels
from benchmarks.instances.judging import Judging
from benchmarks.instances.report import write_report
from benchmarks.instances.results import Instances, Results, instances_of
from benchmarks.instances.store import JudgementStore
from benchmarks.tables.command import call, end_politely, names, stopped
from benchmarks.tables.machine import usable_cpus
from lqd_envs.instances import KINDS, Instance, InstanceError, generate_instances

# Runs differ in how long they take: only over many judgements is the rate even.
_RATE_OVER = 3600.0
_OUT = Path("benchmarks") / "results" / "instances"


@click.command(name="instances")
@click.argument("runs", metavar="RUN...", nargs=-1, type=click.Path(path_type=Path))
@click.option(
    "--count",
    type=click.IntRange(min=1),
    default=20,
    show_default=True,
    help="Instances of each kind, for each task.",
)
@click.option(
    "--seed",
    type=click.IntRange(min=0),
    default=INSTANCE_SEED,
    show_default=True,
    help="Their seed.",
)
@click.option(
    "--kinds", callback=names, help=f"Only these of {','.join(KINDS)}.  [default: all of them]"
)
@click.option(
    "--cap",
    type=click.IntRange(min=1),
    default=200,
    show_default=True,
    help="Most motions of an archive that are drawn at random and simulated in each instance with "
    "obstacles or changes; in the others all are judged.",
)
@click.option(
    "--out",
    type=click.Path(path_type=Path, file_okay=False),
    default=_OUT,
    show_default=True,
    help="Folder of the judgements and the tables.",
)
@click.option(
    "--jobs",
    type=click.IntRange(min=1),
    help="Threads to simulate on; the result does not depend on it.  [default: one for each CPU]",
)
def main(
    *,
    runs: tuple[Path, ...],
    count: int,
    seed: int,
    kinds: list[str] | None,
    cap: int,
    out: Path,
    jobs: int | None,
) -> None:
    """Judge the archives of the finished runs in RUN... by instances of their tasks.

    What has been judged is kept in --out and not judged again. The tables are those of the runs
    that are named; without any, those of all runs that have been judged in --out.
    """
    store = JudgementStore(out, cap)
    folders = [(RunLabel.read(run), run) for run in runs]
    labels = [label for label, _ in folders] or store.runs()
    if not labels:
        raise InstancesError(
            f"Expected runs to judge, or judgements in {out}, but got neither; name the folder of "
            "a run."
        )
    check_labels(labels)
    store.check_archives(labels)
    instances = _instances(labels, kinds=kinds or list(KINDS), count=count, seed=seed)
    with store.alone():
        _judge_missing(store, folders, instances, threads=jobs or usable_cpus())
        paths = write_report(out, Results.load(store, labels, instances, seed=seed))
    for path in paths[:2]:
        click.echo(str(path))


def _instances(
    labels: Sequence[RunLabel], *, kinds: Sequence[str], count: int, seed: int
) -> Instances:
    unknown = [kind for kind in kinds if kind not in KINDS]
    if unknown:
        raise InstanceError(
            f"Expected kinds among {', '.join(KINDS)}, but got {', '.join(unknown)}; leave it out."
        )
    return {
        (task, kind): generate_instances(task, kind, count=count, seed=seed)
        for task in dict.fromkeys(sorted(label.task for label in labels))
        for kind in KINDS
        if kind in kinds
    }


def _judge_missing(
    store: JudgementStore,
    folders: Sequence[tuple[RunLabel, Path]],
    instances: Instances,
    *,
    threads: int,
) -> None:
    asked_of = [(folder, _missing(store, label, instances)) for label, folder in folders]
    missing = [(folder, asked) for folder, asked in asked_of if asked]
    if not missing:
        return
    end_politely()
    progress = Progress(
        TextColumn("{task.completed:.0f} of {task.total:.0f} judgements"),
        BarColumn(),
        TaskProgressColumn(),
        TextColumn("time left"),
        TimeRemainingColumn(),
        console=Console(stderr=True),
        speed_estimate_period=_RATE_OVER,
    )
    try:
        with progress:
            bar = progress.add_task("", total=sum(len(asked) for _, asked in missing))
            for folder, asked in missing:
                # One at a time, since archives are large.
                run = JudgedRun.read(folder)
                judging = Judging(run, cap=store.cap, threads=threads)
                keep = store.keeping(run.label)
                for judgement in judging.judge(asked):
                    keep(judgement)
                    progress.advance(bar)
                progress.console.print(f"{folder}: {len(asked)} instances", soft_wrap=True)
    except KeyboardInterrupt:
        again = join(["python", "-m", "benchmarks.instances", *sys.argv[1:]])
        stopped("what has been judged is kept", again=again)


def _missing(store: JudgementStore, run: RunLabel, instances: Instances) -> list[Instance]:
    judged = store.load(run)
    return [one for one in instances_of(instances, run.task) if one.name not in judged]


if __name__ == "__main__":
    call(main)
