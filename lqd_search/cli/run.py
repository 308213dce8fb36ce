"""`lqd run`: from a task's instruction to an archive on disk."""

from pathlib import Path
from typing import TYPE_CHECKING

import click
import numpy as np

from lqd_envs import Info, LQDError, SolutionSpace, Task, get_task, rollout
from lqd_search.cli.progress import RunProgress
from lqd_search.cli.table import print_summary
from lqd_search.evaluation.functionals import FunctionalEvaluator, Functionals
from lqd_search.evaluation.motion_evaluator import MotionEvaluator, passive_fields
from lqd_search.methods.fitness_exploration import LanguageDrivenQD
from lqd_search.runs.run_config import RunConfig
from lqd_search.runs.run_folder import FunctionText, RunFolder, default_path, refuse_existing
from lqd_search.runs.run_recorder import RunRecorder
from lqd_search.search import search

if TYPE_CHECKING:
    from lqd_llm import InferredFunctionals

# The paper says 50 generations, and nothing of how many solutions they have: 2,048 is ours.
_FULL_BATCH = 2_048
_FULL_EVALUATIONS = 50 * _FULL_BATCH
_FEWEST_GENERATIONS = 32
_EXAMPLE_SEED = 0
_EXAMPLE_SOLUTIONS = 64


@click.command("run", short_help="Search for many motions that do a task.")
@click.argument("task_id", metavar="TASK")
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
    "generations, 2048 at most]",
)
@click.option(
    "--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Seed of the search."
)
@click.option(
    "--sample",
    type=click.IntRange(min=0),
    default=0,
    show_default=True,
    help="Which recorded sample of the language model's replies to use.",
)
@click.option(
    "--threads",
    type=click.IntRange(min=0),
    default=0,
    help="Threads to simulate on; the result does not depend on it.  [default: one for each CPU]",
)
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    help="Folder of the run, which must not exist yet.  [default: runs/<task>-<time>]",
)
def run_command(
    *,
    task_id: str,
    evaluations: int,
    batch_size: int | None,
    seed: int,
    sample: int,
    threads: int,
    out: Path | None,
) -> None:
    """Search for many different motions that do TASK, such as LQD/Faucet-v0.

    The functionals (success condition, fitness functions and behaviour descriptors) are those
    that a language model wrote for the task's instruction, replayed from recordings that ship
    with the package. The archive, its figures and pictures are written to a folder.
    """
    task = get_task(task_id)
    path = out or default_path(task)
    refuse_existing(path)
    inferred = _infer(task, sample=sample)
    functionals = FunctionalEvaluator(
        _functionals(inferred), examples=_examples(task, threads=threads)
    )
    method = _method(task, functionals, evaluations=evaluations, batch_size=batch_size, seed=seed)
    config = _config(task, inferred, functionals, method, seed=seed, sample=sample)
    for sentence in config.dropped:
        click.echo(f"note: {sentence}", err=True)
    folder = RunFolder.create(path, config=config, functionals=_texts(inferred))
    pictures = _search(folder, task, method, MotionEvaluator(task, functionals, threads))
    print_summary(folder.summary())
    click.echo(f"\nRun folder: {folder.path}\nPictures:")
    for picture in pictures:
        click.echo(f"  {picture}")


def _method(
    task: Task,
    functionals: FunctionalEvaluator,
    *,
    evaluations: int,
    batch_size: int | None,
    seed: int,
) -> LanguageDrivenQD:
    return LanguageDrivenQD(
        SolutionSpace(),
        descriptors=functionals.descriptors,
        fitness_names=functionals.fitness_names,
        evaluations=evaluations,
        batch_size=batch_size or default_batch_size(evaluations),
        rng=np.random.default_rng(seed),
        passive_fields=passive_fields(task),
    )


def _config(
    task: Task,
    inferred: "InferredFunctionals",
    functionals: FunctionalEvaluator,
    method: LanguageDrivenQD,
    *,
    seed: int,
    sample: int,
) -> RunConfig:
    return RunConfig(
        task=task.id,
        instruction=task.instruction,
        method="ours",
        seed=seed,
        sample=sample,
        evaluations=method.budget.evaluations,
        batch_size=method.budget.batch_size,
        prompt_hashes=dict(inferred.prompt_hashes),
        model=inferred.model,
        provenance=inferred.provenance,
        dropped=(*inferred.dropped, *functionals.dropped),
    )


def _search(
    folder: RunFolder, task: Task, method: LanguageDrivenQD, evaluate: MotionEvaluator
) -> tuple[Path, ...]:
    """Run the method under a progress bar, write it down, and return the pictures' paths."""
    title = f"{task.id} “{task.instruction}”"
    with RunProgress(title, total=method.budget.evaluations) as progress:
        recorder = RunRecorder(
            folder,
            task=task,
            method=method,
            on_generation=progress.show,
            on_refusal=progress.warn,
        )
        search(method, evaluate, observe=recorder.observe)
    return recorder.finish()


def default_batch_size(evaluations: int) -> int:
    """Return the largest power of two that leaves 32 generations, 2,048 at most.

    The full scale of 102,400 evaluations has 50 generations of 2,048, as many generations as the
    paper; 20,480 evaluations have 40 of 512, and 8,192 have 32 of 256.
    """
    size = 1
    while 2 * size * _FEWEST_GENERATIONS <= evaluations and size < _FULL_BATCH:
        size *= 2
    return size


def _infer(task: Task, *, sample: int) -> "InferredFunctionals":
    try:
        from lqd_llm import infer_from_recording
    except ImportError as error:
        raise LQDError(
            f"Expected the packages of the extra `llm` to infer functionals, but {error.name} is "
            "not installed; run `pip install 'lqd-envs[all]'`."
        ) from error
    return infer_from_recording(
        task.name, instruction=task.instruction, schema=task.schema, sample=sample
    )


def _functionals(inferred: "InferredFunctionals") -> Functionals:
    return Functionals(
        success=inferred.success.call,
        fitness={function.name: function.call for function in inferred.fitness},
        timestamps={function.name: function.call for function in inferred.timestamps},
        quantities={function.name: function.call for function in inferred.quantities},
    )


def _texts(inferred: "InferredFunctionals") -> list[FunctionText]:
    kinds = {
        "success": (inferred.success,),
        "fitness": inferred.fitness,
        "timestamp": inferred.timestamps,
        "quantity": inferred.quantities,
    }
    return [
        FunctionText(kind=kind, name=f.name, description=f.description, code=f.code)
        for kind, functions in kinds.items()
        for f in functions
    ]


def _examples(task: Task, *, threads: int) -> list[Info]:
    """Return moments of the task on which it can be seen what each function gives.

    They come from random motions of their own, whatever these do, and are no part of the search.
    """
    solutions = SolutionSpace().sample(_EXAMPLE_SOLUTIONS, rng=np.random.default_rng(_EXAMPLE_SEED))
    trajectories = rollout(task, solutions, threads=threads)
    motions = (trajectories.infos(int(i)) for i in np.flatnonzero(trajectories.valid))
    return [info for infos in motions for info in (infos[0], infos[-1])]
