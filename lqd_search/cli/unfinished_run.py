"""Beginning a run, and going on with it until it is finished."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np

from lqd_envs import LQDError, get_task
from lqd_search.cli.progress import RunProgress
from lqd_search.cli.recorded import RecordedEvaluator, function_texts, infer, make_judge
from lqd_search.evaluation.cluster import open_cluster
from lqd_search.evaluation.cluster_evaluator import ClusterEvaluator
from lqd_search.evaluation.motion_evaluator import MotionEvaluator
from lqd_search.loop import Evaluate, search
from lqd_search.methods.by_name import FAILURE_COMPETITIONS, METHODS, Setting
from lqd_search.methods.method import Method
from lqd_search.runs.run_config import RunConfig
from lqd_search.runs.run_folder import RunFolder
from lqd_search.runs.run_recorder import RunRecorder
from lqd_search.runs.run_state import RunState


def begin_run(
    path: Path,
    *,
    task_id: str,
    method: str,
    evaluations: int,
    batch_size: int,
    seed: int,
    sample: int,
    failure_competition: str,
    threads: int,
) -> RunFolder:
    """Make the folder of a new run, once it is clear that the run can be carried out.

    Args:
        path: The folder, which does not exist.
        task_id: Id of the task.
        method: Name of the method.
        evaluations: Evaluations to spend.
        batch_size: Solutions in a generation.
        seed: Seed of everything random.
        sample: Which recorded sample of the model's replies.
        failure_competition: How two failures compete for a cell.
        threads: Threads to simulate on; 0: one for each CPU.

    Raises:
        LQDError: The functionals cannot be had or used, the method cannot be set up so, or the
            folder cannot be made.
    """
    task = get_task(task_id)
    inferred = infer(task, sample=sample)
    judge = make_judge(task, inferred, method=method, threads=threads)
    config = RunConfig(
        task=task.id,
        instruction=task.instruction,
        method=method,
        seed=seed,
        sample=sample,
        evaluations=evaluations,
        batch_size=batch_size,
        explored=len(inferred.fitness),
        failure_competition=failure_competition,
        prompt_hashes=dict(inferred.prompt_hashes),
        model=inferred.model,
        provenance=inferred.provenance,
        dropped=(*inferred.dropped, *judge.dropped),
    )
    evaluate = MotionEvaluator(task, judge, threads)
    # Before the folder is there: a budget that does not suffice is no reason for one.
    new_method(config, evaluate)
    return RunFolder.create(
        path, config=config, functionals=function_texts(inferred, method=method)
    )


def go_on(folder: RunFolder, *, threads: int, workers: str | None) -> tuple[Path, ...]:
    """Go on with a run from its last checkpoint, or from its start, until it is finished.

    Args:
        folder: The run's folder.
        threads: Threads to simulate on; 0: one for each CPU.
        workers: Where to evaluate, as `open_cluster` takes it; None: here.

    Returns:
        The pictures.

    Raises:
        LQDError: The run cannot go on; what was finished is kept.
    """
    config = folder.config()
    recipe = RecordedEvaluator(config.task, config.method, config.sample, threads)
    _check_choices(folder, config)
    _check_functionals(folder, config)
    here = recipe()
    state = folder.state.load() or RunState(new_method(config, here))
    with RunProgress(
        f"{here.task.id} \u201c{here.task.instruction}\u201d, {config.method}",
        total=config.evaluations,
        folder=folder.path,
    ) as progress:
        recorder = RunRecorder(
            folder,
            task=here.task,
            state=state,
            on_generation=progress.show,
            on_refusal=progress.warn,
        )
        if state.metrics:
            progress.show(state.metrics[-1])
        with _evaluator(here, recipe, workers=workers) as evaluate:
            search(state.method, evaluate, observe=recorder.observe)
    return recorder.finish()


@contextmanager
def _evaluator(
    here: MotionEvaluator, recipe: RecordedEvaluator, *, workers: str | None
) -> Iterator[Evaluate]:
    if workers is None:
        yield here
        return
    with open_cluster(workers) as client:
        # Dask runs as many processes as there are to be busy; each simulates on one thread.
        yield ClusterEvaluator(client, replace(recipe, threads=1))


def new_method(config: RunConfig, evaluate: MotionEvaluator) -> Method:
    """Return a run's method, before its first generation.

    Args:
        config: What the run was asked to do.
        evaluate: Its evaluator.
    """
    return METHODS[config.method].build(
        Setting(
            task=evaluate.task,
            judge=evaluate.judge,
            evaluations=config.evaluations,
            batch_size=config.batch_size,
            rng=np.random.default_rng(config.seed),
            explored=config.explored,
            failure_competition=config.failure_competition,
        )
    )


def _check_choices(folder: RunFolder, config: RunConfig) -> None:
    for what, given, known in (
        ("method", config.method, tuple(METHODS)),
        ("failure_competition", config.failure_competition, FAILURE_COMPETITIONS),
    ):
        if given not in known:
            raise LQDError(
                f"Expected one of {', '.join(known)} as {what} in the config.json of "
                f"{folder.path}, but got {given!r}; restore the file, or install the version of "
                "lqd-envs that it names."
            )


def _check_functionals(folder: RunFolder, config: RunConfig) -> None:
    task = get_task(config.task)
    texts = function_texts(infer(task, sample=config.sample), method=config.method)
    if {text.file_name: text.source for text in texts} != folder.functionals():
        raise LQDError(
            f"Expected the functionals in {folder.path} to be those of the recorded sample "
            f"{config.sample}, but they differ: the run cannot go on as it began; restore the "
            "folder, or install the version of lqd-envs that its config.json names."
        )
