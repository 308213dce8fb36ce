"""Beginning a run, and going on with it until it is finished."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from shlex import quote
from typing import TYPE_CHECKING

import numpy as np

from lqd_envs import LQDError, Task
from lqd_search.cli.evaluator_recipe import EvaluatorRecipe
from lqd_search.cli.progress import RunProgress
from lqd_search.cli.run_functionals import RunFunctionals
from lqd_search.evaluation.cluster import open_cluster
from lqd_search.evaluation.cluster_evaluator import ClusterEvaluator
from lqd_search.evaluation.motion_evaluator import MotionEvaluator
from lqd_search.evaluation.stopped_functions import MakeEvaluate, WithoutStopped
from lqd_search.loop import search
from lqd_search.methods.by_name import FAILURE_COMPETITIONS, METHODS, Setting
from lqd_search.methods.method import Method
from lqd_search.methods.plus_switches import Switch
from lqd_search.methods.steering import STEERING
from lqd_search.runs.function_text import FunctionText, functionals_digest
from lqd_search.runs.run_config import RunConfig
from lqd_search.runs.run_folder import RunFolder
from lqd_search.runs.run_recorder import RunRecorder
from lqd_search.runs.run_state import RunState

if TYPE_CHECKING:
    from distributed import Client

    from lqd_llm import Usage

# Where there are none to explore, `direct` still learns its ranges again when three would end.
_EXPLORED = 3


def begin_run(
    path: Path,
    *,
    task: Task,
    functionals: RunFunctionals,
    method: str,
    evaluations: int,
    batch_size: int,
    seed: int,
    sample: int,
    failure_competition: str,
    allow_weak: bool,
) -> RunFolder:
    """Make the folder of a new run, once it is clear that the run can be carried out.

    Args:
        path: The folder, which does not exist.
        task: The task.
        functionals: What steers the run.
        method: Name of the method.
        evaluations: Evaluations to spend.
        batch_size: Solutions in a generation.
        seed: Seed of everything random.
        sample: Which of several inferences of the task.
        failure_competition: How two failures compete for a cell.
        allow_weak: Whether the sandbox may lack locks that this system does not have.

    Raises:
        LQDError: The functionals cannot be used, the method cannot be set up so, or the folder
            cannot be made.
    """
    checked = functionals.checked
    usage = checked.usage
    config = RunConfig(
        task=task.id,
        instruction=functionals.instruction,
        method=method,
        seed=seed,
        sample=sample,
        evaluations=evaluations,
        batch_size=batch_size,
        explored=sum(text.kind == "fitness" for text in checked.texts) or _EXPLORED,
        failure_competition=failure_competition,
        switches=tuple(sorted(METHODS[method].switches)),
        llm=functionals.llm,
        prompt_hashes=dict(checked.prompt_hashes),
        model=checked.model,
        provenance=checked.provenance,
        functionals=functionals_digest(checked.texts) if checked.texts else "",
        lengths=dict(checked.lengths),
        dropped=checked.dropped,
        repaired=checked.repaired,
        remarks=checked.remarks,
        usage={} if usage is None else _numbers(usage),
        usage_in_words="" if usage is None else usage.summary(),
    )
    recipe = EvaluatorRecipe.of(
        task.id,
        steering=STEERING[method],
        functions=checked.texts,
        lengths=checked.lengths,
        allow_weak=allow_weak,
    )
    # Before the folder is there: a budget that does not suffice is no reason for one.
    with recipe.opened() as evaluate:
        new_method(config, evaluate)
    kept = functionals.kept
    folder = RunFolder.create(
        path,
        config=config,
        functionals=checked.texts,
        origin=functionals.origin,
        inference=None if kept is None else kept.path,
    )
    if kept is not None:
        kept.remove()
    return folder


def go_on(
    folder: RunFolder, *, threads: int, client: "Client | None", allow_weak: bool
) -> tuple[Path, ...]:
    """Go on with a run from its last checkpoint, or from its start, until it is finished.

    Args:
        folder: The run's folder.
        threads: Threads to simulate on; 0: one for each CPU.
        client: The cluster to evaluate on; None: here.
        allow_weak: Whether the sandbox may lack locks that this system does not have.

    Returns:
        The pictures.

    Raises:
        LQDError: The run cannot go on; what was finished is kept.
    """
    with folder.locked():
        # Another process may have finished it just before.
        if folder.finished:
            raise LQDError(
                f"Expected an unfinished run in {folder.path}, but it is finished by now; see its "
                f"figures with `lqd show {quote(str(folder.path))}`."
            )
        return _go_on(folder, threads=threads, client=client, allow_weak=allow_weak)


def _go_on(
    folder: RunFolder, *, threads: int, client: "Client | None", allow_weak: bool
) -> tuple[Path, ...]:
    config = folder.config()
    _check_choices(folder, config)
    functionals = _unchanged_functionals(folder, config)
    recipe = EvaluatorRecipe.of(
        config.task,
        steering=STEERING[config.method],
        functions=functionals,
        lengths=config.lengths,
        threads=threads,
        allow_weak=allow_weak,
    )
    with recipe.opened() as here:
        state = folder.load_state() or RunState(config, new_method(config, here))
        make = _maker(recipe, client)
        evaluate = WithoutStopped(
            here if client is None and not state.stopped else make(state.stopped),
            make=make,
            stopped=state.stopped,
        )
        with _recorder(folder, config, task=here.task, state=state) as recorder:
            search(state.method, evaluate, observe=recorder.observe)
        return recorder.finish()


def _maker(recipe: EvaluatorRecipe, client: "Client | None") -> MakeEvaluate:
    if client is None:
        return lambda stopped: recipe.without(stopped)()
    # Dask runs as many processes as there are to be busy; each simulates on one thread.
    spread = replace(recipe, threads=1)
    return lambda stopped: ClusterEvaluator(client, spread.without(stopped))


def _numbers(usage: "Usage") -> dict[str, int | float | None]:
    return {name: n for name, n in usage.to_dict().items() if name != "unpriced"}


@contextmanager
def _recorder(
    folder: RunFolder, config: RunConfig, *, task: Task, state: RunState
) -> Iterator[RunRecorder]:
    with RunProgress(
        f"{task.id} \u201c{config.instruction}\u201d, {config.method}",
        total=config.evaluations,
        folder=folder.path,
    ) as progress:
        recorder = RunRecorder(
            folder,
            task=task,
            state=state,
            on_generation=progress.show,
            on_refusal=progress.warn,
            on_stopped=progress.warn_stopped,
        )
        if state.metrics:
            progress.show(state.metrics[-1])
        yield recorder


@contextmanager
def cluster_at(workers: str | None) -> Iterator["Client | None"]:
    """Connect to the cluster that a run is evaluated on, for the length of a `with` block.

    Args:
        workers: Where it is, as `open_cluster` takes it; None: there is none.

    Raises:
        ClusterError: It cannot be used.
    """
    if workers is None:
        yield None
        return
    with open_cluster(workers) as client:
        yield client


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
            switches=frozenset(map(Switch, config.switches)),
        )
    )


def _check_choices(folder: RunFolder, config: RunConfig) -> None:
    for what, given, known in (
        ("method", config.method, tuple(METHODS)),
        ("failure_competition", config.failure_competition, FAILURE_COMPETITIONS),
        *(("switch", switch, tuple(Switch)) for switch in config.switches),
    ):
        if given not in known:
            raise LQDError(
                f"Expected one of {', '.join(known)} as {what} in the config.json of "
                f"{folder.path}, but got {given!r}; restore the file, begin another run, or go on "
                "with the sources of lqd-envs that wrote it."
            )


def _unchanged_functionals(folder: RunFolder, config: RunConfig) -> tuple[FunctionText, ...]:
    texts = folder.functionals()
    if texts and functionals_digest(texts) != config.functionals:
        raise LQDError(
            f"Expected the functionals in {folder.path} to be those that the run began with, but "
            "they were changed; restore them, or begin another run with "
            f"`lqd run {config.task} --functionals {quote(str(folder.path / 'functionals'))}` and "
            "the method, seed and evaluations that you want."
        )
    return texts
