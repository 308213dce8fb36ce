"""`lqd adapt`: the motions of a run that solve one instance of its task."""

import sys
from pathlib import Path
from typing import NoReturn

import click
import numpy as np
from numpy.typing import NDArray

from lqd_envs import LQDError, Task, get_task
from lqd_envs.instances import Instance
from lqd_envs.rendering_backend import has_display
from lqd_search.adaptation.archive_view import ArchiveView
from lqd_search.adaptation.attempts import Attempts, try_motions
from lqd_search.adaptation.instance_replay import replay_in
from lqd_search.adaptation.selectors import SELECTORS, NamedSelector
from lqd_search.cli.kept_solution import KeptSolution, check_solution_path
from lqd_search.cli.named_instance import SYNTAX, in_words, listed_instances, named_instance
from lqd_search.cli.video import check_video_path, write_video
from lqd_search.runs.replay import Replay
from lqd_search.runs.run_folder import RunFolder
from lqd_search.runs.stored_archive import StoredArchive

_FAILED = 1
_DIFFERENT = (
    "Expected the env to show the motion that solved the instance, but step by step it differs "
    "from the batch simulation; see `lqd doctor`, and report it with the versions that it names."
)
_LISTED = 3
_ROWS_SHOWN = 10


@click.command("adapt")
@click.argument("folder", metavar="DIR", type=click.Path(path_type=Path))
@click.option(
    "--instance",
    "instance_text",
    metavar=SYNTAX,
    help="The instance: a JSON file of one, or the N-th drawn one of a kind, from 0, with a seed, "
    "such as obstacles:3; N and SEED are 0 if left out.",
)
@click.option(
    "--list",
    "list_only",
    is_flag=True,
    help=f"Show the first {_LISTED} drawn instances of each kind and what they ask; try nothing.",
)
@click.option(
    "--selector",
    type=click.Choice(tuple(SELECTORS)),
    # With few tries it solves more of the benchmark's instances than the order of fitness.
    default="diverse",
    show_default=True,
    help="In which order to try: "
    + "; ".join(f"{selector.name}, {selector.summary}" for selector in SELECTORS.values())
    + ".",
)
@click.option(
    "--limit",
    type=click.IntRange(min=1),
    default=100,
    show_default=True,
    help="Most motions to try.",
)
@click.option(
    "--threads",
    type=click.IntRange(min=0),
    default=0,
    help="Threads to simulate on; the result does not depend on it.  [default: one for each CPU]",
)
@click.option(
    "--video",
    type=click.Path(path_type=Path, dir_okay=False),
    help="Write a video (.mp4) of the first one instead of opening a window.",
)
@click.option(
    "--out",
    type=click.Path(path_type=Path, dir_okay=False),
    help="Keep the first one, and which others solve it, in this new JSON file.",
)
def adapt_command(
    *,
    folder: Path,
    instance_text: str | None,
    list_only: bool,
    selector: str,
    limit: int,
    threads: int,
    video: Path | None,
    out: Path | None,
) -> None:
    """Find the motions of the run in DIR that solve an instance of its task.

    The motions that the run's own success condition approves are simulated in the instance, one
    after the other in the order of a selector, which does not know the instance. That condition
    was inferred, and nothing is asked of the expert, unless the expert steered the run. It shows
    how many tries it took and carries out the first one that solves the instance: in a window
    where there is a display. The exit status is 1 where none solves it, and where the env shows
    another motion than was simulated before, which is then not kept.
    """
    run = RunFolder.open(folder)
    config = run.config()
    task = get_task(config.task)
    if list_only:
        click.echo(listed_instances(task, count=_LISTED))
        return
    instance = _prepare(instance_text, task, video=video, out=out)
    archive = run.archive()
    # Where the expert steered the run, so does what it stored, and the order in which it is tried.
    approves = "expert's" if config.steered_by_expert else "inferred"
    solving, tries = _try(
        archive,
        task=task,
        instance=instance,
        selector=SELECTORS[selector],
        limit=limit,
        threads=threads,
        condition=f"the {approves} condition",
    )
    elite = solving[0]
    solution = archive.fields["solution"][elite]
    _show(instance, solution, title=f"elite {elite} of {len(archive)}", video=video)
    if out:
        KeptSolution(
            instance=instance,
            solution=solution,
            elite=elite,
            method=config.method,
            run_seed=config.seed,
            selector=selector,
            tries=tries,
            solving=solving,
        ).write(out)
        click.echo(f"kept in: {out}")


def _prepare(text: str | None, task: Task, *, video: Path | None, out: Path | None) -> Instance:
    if text is None:
        raise LQDError(
            f"Expected an instance, but got none; name one with --instance {SYNTAX}, or see what "
            "there is with --list."
        )
    instance = named_instance(text, task)
    if video and out and video.absolute() == out.absolute():
        raise LQDError(
            f"Expected two files, but --video and --out are both {out}; choose another name for "
            "one of them."
        )
    if video:
        check_video_path(video)
    if out:
        check_solution_path(out)
    return instance


def _try(
    archive: StoredArchive,
    *,
    task: Task,
    instance: Instance,
    selector: NamedSelector,
    limit: int,
    threads: int,
    condition: str,
) -> tuple[tuple[int, ...], int]:
    """Return the elites that solve the instance, as they were tried, and when the first one did."""
    click.echo("\n".join([f"instance {instance.name}", *in_words(instance)]))
    attempts = try_motions(
        ArchiveView.of(archive),
        task=task,
        instance=instance,
        select=selector.select,
        limit=limit,
        threads=threads,
    )
    click.echo(_describe(attempts, selector, condition=condition))
    if attempts.tries is None:
        _end(_nothing_found(attempts, instance))
    return tuple(map(int, attempts.solving)), attempts.tries


def _show(
    instance: Instance, solution: NDArray[np.float64], *, title: str, video: Path | None
) -> None:
    mode = "rgb_array" if video else "human" if has_display() else None
    shown = replay_in(instance, solution, render_mode=mode)
    click.echo(_report(shown, title=title, solution=solution))
    if not (shown.success and shown.same_as_batch):
        _end(_DIFFERENT)
    if video:
        write_video(video, shown.frames)
        click.echo(f"video: {video}")


def _end(why: str) -> NoReturn:
    click.echo(f"lqd: {why}", err=True)
    sys.exit(_FAILED)


def _describe(attempts: Attempts, selector: NamedSelector, *, condition: str) -> str:
    found = len(attempts.solving)
    lines = [
        f"tried {len(attempts.rows)} of the {attempts.candidates} motions that {condition} "
        f"approves, {selector.summary}"
    ]
    if attempts.tries is not None:
        rows = ", ".join(map(str, attempts.solving[:_ROWS_SHOWN]))
        more = f" and {found - _ROWS_SHOWN} more" if found > _ROWS_SHOWN else ""
        lines += [
            f"{found} of them {'solves' if found == 1 else 'solve'} the instance, the first after "
            f"{attempts.tries} {'try' if attempts.tries == 1 else 'tries'}",
            f"in this order, elites {rows}{more}",
        ]
    return "\n".join(lines)


def _nothing_found(attempts: Attempts, instance: Instance) -> str:
    tried = len(attempts.rows)
    more = (
        "raise --limit, choose another --selector or search longer"
        if tried < attempts.candidates
        else "search longer, or with another method"
    )
    return f"Expected a motion that solves {instance.name}, but none of {tried} does; {more}."


def _report(shown: Replay, *, title: str, solution: NDArray[np.float64]) -> str:
    return "\n".join(
        [
            title,
            f"solution: {np.array2string(solution, precision=4, separator=', ')}",
            f"solved, step by step in the env: {_yes(shown.success)}",
            f"infos equal to a batch rollout's, bit for bit: {_yes(shown.same_as_batch)}",
        ]
    )


def _yes(answer: bool) -> str:
    return "yes" if answer else "no"
