"""The run of one variant of `ours`: `python -m benchmarks.tables.ablation_run CELL FOLDER`."""

import sys
from collections.abc import Sequence
from pathlib import Path

import click
import numpy as np

from benchmarks.tables.cell import Cell
from benchmarks.tables.cell_figures import CellError
from benchmarks.tables.cell_process import CellCommand
from benchmarks.tables.command import call
from benchmarks.tables.steered_run import Steering, steered_by_recording
from benchmarks.tables.subset_evaluator import SubsetEvaluator
from benchmarks.tables.variants import VARIANTS, Variant
from lqd_search.cli.llm_options import REPLAY
from lqd_search.evaluation.values import Refusal, StoppedFunction
from lqd_search.loop import search
from lqd_search.methods.by_name import Setting
from lqd_search.runs.function_text import functionals_digest
from lqd_search.runs.metrics import Metrics
from lqd_search.runs.run_config import RunConfig
from lqd_search.runs.run_folder import RunFolder
from lqd_search.runs.run_recorder import RunRecorder
from lqd_search.runs.run_state import RunState


def ablation_command(*, evaluations: int, batch_size: int) -> CellCommand:
    """Return how the cell of a variant is run."""

    def command(cell: Cell, folder: Path) -> Sequence[str]:
        return (
            *(sys.executable, "-m", "benchmarks.tables.ablation_run", str(folder)),
            *("--task", cell.task, "--variant", cell.method),
            *("--seed", str(cell.seed), "--sample", str(cell.sample)),
            *("--evaluations", str(evaluations), "--batch-size", str(batch_size)),
        )

    return command


def run_variant(cell: Cell, folder: Path, *, evaluations: int, batch_size: int) -> None:
    """Run a variant in a run folder, or go on with the run that is there.

    The folder says the variant's name for its method, so that `lqd run --resume`, which would go on
    with the whole mesh, refuses it.

    Args:
        cell: The cell; its method is the name of a variant.
        folder: The folder of the run.
        evaluations: Evaluations to spend.
        batch_size: Solutions in a generation.

    Raises:
        LQDError: The functionals cannot be used or are not those that the run began with, the run
            is finished, or the folder is damaged or cannot be written.
    """
    with steered_by_recording(cell.task_id, sample=cell.sample) as steering:
        run = (
            RunFolder.open(folder)
            if folder.exists()
            else _create(folder, cell, steering, evaluations=evaluations, batch_size=batch_size)
        )
        with run.locked():
            _check_can_go_on(run, steering)
            _go_on(run, VARIANTS[cell.method], steering)


def _check_can_go_on(run: RunFolder, steering: Steering) -> None:
    if run.finished:
        raise CellError(
            f"Expected a run in {run.path} that can go on, but it is finished; delete it to run it "
            "again."
        )
    if run.config().functionals != _digest(steering):
        raise CellError(
            f"Expected the run in {run.path} to have begun with the functionals of the recording, "
            "but it has others; delete it, and the cell is run anew."
        )


def _go_on(run: RunFolder, variant: Variant, steering: Steering) -> None:
    config = run.config()
    setting = Setting(
        task=steering.task,
        judge=steering.here.judge,
        evaluations=config.evaluations,
        batch_size=config.batch_size,
        rng=np.random.default_rng(config.seed),
    )
    state = run.load_state() or RunState(config, variant.method(setting))
    recorder = RunRecorder(
        run,
        task=steering.task,
        state=state,
        on_generation=_say_generation,
        on_refusal=_say_refusal,
        on_stopped=_say_stopped,
    )
    kept = variant.choose(tuple(setting.judge.descriptors))
    evaluate = SubsetEvaluator(steering.evaluate(state.stopped), kept)
    search(state.method, evaluate, observe=recorder.observe)
    recorder.finish()


def _create(
    folder: Path, cell: Cell, steering: Steering, *, evaluations: int, batch_size: int
) -> RunFolder:
    functionals = steering.functionals
    config = RunConfig(
        task=cell.task_id,
        instruction=steering.task.instruction,
        method=cell.method,
        seed=cell.seed,
        sample=cell.sample,
        evaluations=evaluations,
        batch_size=batch_size,
        explored=len(steering.here.judge.fitness_names),
        failure_competition="coin" if cell.method == "coin" else "fitness",
        llm=REPLAY,
        prompt_hashes=dict(functionals.prompt_hashes),
        model=functionals.model,
        provenance=functionals.provenance,
        functionals=_digest(steering),
        lengths=dict(functionals.lengths),
        dropped=functionals.dropped,
        repaired=functionals.repaired,
        remarks=functionals.remarks,
    )
    return RunFolder.create(folder, config=config, functionals=functionals.texts)


def _digest(steering: Steering) -> str:
    texts = steering.functionals.texts
    return functionals_digest(texts) if texts else ""


def _say_generation(metrics: Metrics) -> None:
    click.echo(f"{metrics.evaluations} evaluations, {metrics.success_archive_size} successes")


def _say_refusal(refusal: Refusal, motion: int) -> None:
    click.echo(f"note: {refusal.kind} {refusal.functional!r} {refusal.reason} for motion {motion}")


def _say_stopped(stopped: StoppedFunction) -> None:
    click.echo(f"note: {stopped}")


@click.command(name="ablation_run")
@click.argument("folder", type=click.Path(path_type=Path))
@click.option("--task", required=True)
@click.option("--variant", type=click.Choice(tuple(VARIANTS)), required=True)
@click.option("--seed", type=int, required=True)
@click.option("--sample", type=int, required=True)
@click.option("--evaluations", type=int, required=True)
@click.option("--batch-size", type=int, required=True)
def main(
    *,
    folder: Path,
    task: str,
    variant: str,
    seed: int,
    sample: int,
    evaluations: int,
    batch_size: int,
) -> None:
    """Run a variant in FOLDER, or go on with the run that is there."""
    run_variant(
        Cell(task, variant, seed, sample), folder, evaluations=evaluations, batch_size=batch_size
    )


if __name__ == "__main__":
    call(main)
