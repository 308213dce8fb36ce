"""`lqd run`: from a task's instruction to an archive on disk."""

import sys
from pathlib import Path
from shlex import quote
from typing import TYPE_CHECKING

import click

from lqd_envs import LQDError, get_task
from lqd_search.cli.llm_options import LLMOptions, llm_options
from lqd_search.cli.run_functionals import FunctionalsSource
from lqd_search.cli.table import print_summary
from lqd_search.cli.unfinished_run import begin_run, cluster_at, go_on
from lqd_search.methods.by_name import FAILURE_COMPETITIONS, METHODS
from lqd_search.runs.default_path import default_path
from lqd_search.runs.new_folder import refuse_existing
from lqd_search.runs.run_folder import RunFolder

if TYPE_CHECKING:
    from distributed import Client

# The paper says 50 generations, and nothing of how many solutions they have: 2,048 is ours.
_FULL_BATCH = 2_048
_FULL_EVALUATIONS = 50 * _FULL_BATCH
_FEWEST_GENERATIONS = 32
_INTERRUPTED = 130
# What may be chosen anew when a run goes on; the result depends on none of it.
_FREE = ("resume", "threads", "workers", "allow_weak_sandbox")
# What says how to infer, and means nothing where functionals are there already.
_INFERRING = ("llm", "recordings", "instruction", "model", "effort", "max_tokens", "sample")


@click.command("run")
@click.argument("task_id", metavar="[TASK]", required=False)
@click.option(
    "--method",
    type=click.Choice(tuple(METHODS)),
    default="ours",
    show_default=True,
    help="How to search: " + "; ".join(f"{k}, {m.summary}" for k, m in METHODS.items()) + ".",
)
@click.option(
    "--evaluations",
    type=click.IntRange(min=1),
    default=_FULL_EVALUATIONS,
    show_default=True,
    help="Solutions to evaluate in all.",
)
@click.option(
    "--batch-size",
    type=click.IntRange(min=1),
    help="Solutions in a generation.  [default: the largest power of two that leaves 32 "
    "generations, 2048 at most; at least 2 for ga]",
)
@click.option(
    "--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Seed of the search."
)
@llm_options
@click.option(
    "--functionals",
    metavar="DIR",
    type=click.Path(path_type=Path, file_okay=False),
    help="Folder of functionals to use instead of inferring them, as `lqd infer --out` and every "
    "run write it; a person may have edited it.",
)
@click.option(
    "--allow-weak-sandbox",
    is_flag=True,
    help="Run functionals that do not ship with the package even where the sandbox lacks a layer; "
    "`lqd doctor` says whether it does.",
)
@click.option(
    "--failure-competition",
    type=click.Choice(FAILURE_COMPETITIONS),
    default=FAILURE_COMPETITIONS[0],
    show_default=True,
    help="How two failures compete for a cell.",
)
@click.option(
    "--threads",
    type=click.IntRange(min=0),
    default=0,
    help="Threads to simulate on; the result does not depend on it.  [default: one for each CPU]",
)
@click.option(
    "--workers",
    metavar="WHERE",
    help="Evaluate on a Dask cluster: tcp://HOST:PORT, or local:N for N processes here; the result "
    "does not depend on it, on processors of the same kind.",
)
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    help="Folder of the run, which must not exist yet.  [default: runs/<task>-<time>]",
)
@click.option(
    "--resume",
    metavar="DIR",
    type=click.Path(path_type=Path),
    help="Go on with the run in DIR, which was stopped; give neither TASK nor anything but "
    "--threads, --workers and --allow-weak-sandbox.",
)
@click.pass_context
def run_command(
    context: click.Context,
    *,
    task_id: str | None,
    method: str,
    evaluations: int,
    batch_size: int | None,
    seed: int,
    sample: int,
    llm: LLMOptions,
    instruction: str | None,
    functionals: Path | None,
    allow_weak_sandbox: bool,
    failure_competition: str,
    threads: int,
    workers: str | None,
    out: Path | None,
    resume: Path | None,
) -> None:
    """Search for many different motions that do TASK, such as LQD/Faucet-v0.

    The functionals (success condition, fitness functions and behaviour descriptors) are those
    that a language model wrote for the task's instruction: without further options, replies that
    ship with the package; with --llm live, those of a model that is asked through the Anthropic
    API. They are checked, and run in a sandbox. The archive, its figures and pictures are written
    to a folder. A checkpoint is kept after each generation: a run that was stopped, however, goes
    on with --resume and ends as if it had not been.
    """
    with cluster_at(workers) as client:
        if resume is not None:
            _refuse_other_options(context)
            folder = RunFolder.open(resume)
        elif task_id is None:
            raise LQDError(
                "Expected a TASK, such as LQD/Faucet-v0, or --resume DIR, but got neither; name "
                "one of them."
            )
        else:
            if functionals is not None:
                _refuse_inferring(context)
            task = get_task(task_id)
            path = out or default_path(task)
            refuse_existing(path)
            named = METHODS[method]
            size = batch_size or max(default_batch_size(evaluations), named.smallest_batch)
            # Before anything is inferred, which takes a while and may have to be paid for.
            named.check_size(evaluations=evaluations, batch_size=size)
            source = FunctionalsSource(llm, instruction, sample, functionals)
            with source.get(
                task, method=method, output=path, threads=threads, allow_weak=allow_weak_sandbox
            ) as found:
                folder = begin_run(
                    path,
                    task=task,
                    functionals=found,
                    method=method,
                    evaluations=evaluations,
                    batch_size=size,
                    seed=seed,
                    sample=sample,
                    failure_competition=failure_competition,
                    allow_weak=allow_weak_sandbox,
                )
        _finish(folder, threads=threads, client=client, allow_weak=allow_weak_sandbox)


def _finish(folder: RunFolder, *, threads: int, client: "Client | None", allow_weak: bool) -> None:
    config = folder.config()
    for sentence in (*config.dropped, *config.repaired):
        click.echo(f"note: {sentence}", err=True)
    if folder.finished:
        click.echo(f"note: the run in {folder.path} is finished; these are its figures", err=True)
        folder.state.remove()
        print_summary(folder.summary())
        return
    _note_changed_versions(folder)
    try:
        pictures = go_on(folder, threads=threads, client=client, allow_weak=allow_weak)
    except KeyboardInterrupt:
        again = f"lqd run --resume {quote(str(folder.path))}"
        if allow_weak:
            again += " --allow-weak-sandbox"
        click.echo(f"lqd: stopped; go on with `{again}`", err=True)
        sys.exit(_INTERRUPTED)
    print_summary(folder.summary())
    click.echo(f"\nRun folder: {folder.path}\nPictures:")
    for picture in pictures:
        click.echo(f"  {picture}")


def _refuse_other_options(context: click.Context) -> None:
    given = [name for name in _given(context) if name not in _FREE]
    if given:
        raise LQDError(
            "Expected nothing but --threads, --workers and --allow-weak-sandbox beside --resume, "
            f"since a run goes on as it began, but got {_options(given)}; leave it out, or begin "
            "another run."
        )


def _refuse_inferring(context: click.Context) -> None:
    given = [name for name in _given(context) if name in _INFERRING]
    if given:
        raise LQDError(
            "Expected no option that says how to infer functionals beside --functionals, but got "
            f"{_options(given)}; leave out the one or the other."
        )


def _given(context: click.Context) -> list[str]:
    source = click.core.ParameterSource.COMMANDLINE
    return [name for name in context.params if context.get_parameter_source(name) is source]


def _options(names: list[str]) -> str:
    return ", ".join("TASK" if n == "task_id" else f"--{n.replace('_', '-')}" for n in names)


def _note_changed_versions(folder: RunFolder) -> None:
    changed = folder.config().changed_versions()
    if changed:
        versions = ", ".join(f"{k} {ran} (here {here})" for k, (ran, here) in changed.items())
        click.echo(
            f"note: the run began with other versions, {versions}; it may end otherwise than it "
            "would have with them",
            err=True,
        )


def default_batch_size(evaluations: int) -> int:
    """Return the largest power of two that leaves 32 generations, 2,048 at most.

    The full scale of 102,400 evaluations has 50 generations of 2,048, as many generations as the
    paper; 20,480 evaluations have 40 of 512, and 8,192 have 32 of 256.
    """
    size = 1
    while 2 * size * _FEWEST_GENERATIONS <= evaluations and size < _FULL_BATCH:
        size *= 2
    return size
