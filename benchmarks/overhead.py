"""How much of a run is not physics and functionals: `python -m benchmarks.overhead`."""

import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeVar

import click
import numpy as np

from benchmarks.recorded_recipe import recorded_functionals, recorded_recipe
from lqd_envs import get_task
from lqd_search.cli.llm_options import REPLAY
from lqd_search.cli.run import default_batch_size
from lqd_search.cli.run_functionals import RunFunctionals
from lqd_search.cli.unfinished_run import begin_run, new_method
from lqd_search.loop import Generation
from lqd_search.runs.run_recorder import RunRecorder
from lqd_search.runs.run_state import RunState

_Result = TypeVar("_Result")
_BLOCK = 5


@dataclass
class Clock:
    """Seconds by part of the loop, a list entry for each generation.

    Attributes:
        parts: For each part its seconds, generation by generation.
        motions: Valid motions, generation by generation.
    """

    parts: dict[str, list[float]] = field(default_factory=dict)
    motions: list[int] = field(default_factory=list)

    def time(self, part: str, call: Callable[[], _Result]) -> _Result:
        """Call, and note how long it took."""
        began = time.perf_counter()
        result = call()
        self.parts.setdefault(part, []).append(time.perf_counter() - began)
        return result


def measure(task_id: str, *, evaluations: int, seed: int, threads: int) -> Clock:
    """Run `ours` as `lqd run` does, and time each part of each generation.

    Args:
        task_id: The task.
        evaluations: Evaluations to spend.
        seed: Seed of the search.
        threads: Threads to simulate on; 0: one for each CPU.
    """
    clock, task = Clock(), get_task(task_id)
    recipe = recorded_recipe(task, method="ours", sample=0, threads=threads)
    with tempfile.TemporaryDirectory() as parent, recipe.opened() as evaluate:
        folder = begin_run(
            Path(parent) / "run",
            task=task,
            functionals=RunFunctionals(
                REPLAY, task.instruction, recorded_functionals(task, sample=0)
            ),
            method="ours",
            evaluations=evaluations,
            batch_size=default_batch_size(evaluations),
            seed=seed,
            sample=0,
            failure_competition="fitness",
            allow_weak=False,
        )
        state = RunState(folder.config(), new_method(folder.config(), evaluate))
        method = state.method
        recorder = RunRecorder(
            folder,
            task=evaluate.task,
            state=state,
            on_generation=lambda _: None,
            on_refusal=lambda *_: None,
            on_stopped=lambda _: None,
        )
        while not method.done:
            stage, evaluation = method.stage, method.evaluations
            solutions = clock.time("ask", method.ask)
            values = clock.time("physics and functionals", lambda s=solutions: evaluate(s))
            clock.time("tell", lambda v=values: method.tell(v))
            generation = Generation(stage, evaluation, solutions, values)
            clock.time("record", lambda g=generation: recorder.observe(g))
            clock.motions.append(int(values.valid.sum()))
        clock.time("finish", recorder.finish)
    return clock


def table(clock: Clock) -> str:
    """Return the medians of blocks of generations as a Markdown table."""
    lines = [
        "| generations | valid motions | physics and functionals, s | ask, s | tell, s | record, s "
        "| share outside | ms a valid motion |",
        "|---|---:|---:|---:|---:|---:|---:|---:|",
    ]
    parts = ("physics and functionals", "ask", "tell", "record")
    columns = np.array([clock.parts[part] for part in parts])
    motions = np.array(clock.motions)
    for first in range(0, columns.shape[1], _BLOCK):
        block = slice(first, first + _BLOCK)
        seconds = np.median(columns[:, block], axis=1)
        total = columns[:, block].sum(axis=0)
        lines.append(
            f"| {first + 1} to {min(first + _BLOCK, columns.shape[1])} "
            f"| {np.median(motions[block]):.0f} | {seconds[0]:.2f} | {seconds[1]:.3f} "
            f"| {seconds[2]:.3f} | {seconds[3]:.3f} "
            f"| {np.median(columns[1:, block].sum(axis=0) / total):.1%} "
            f"| {np.median(total / motions[block]) * 1e3:.2f} |"
        )
    share = columns[1:].sum() / columns.sum()
    lines += [
        "",
        f"Outside physics and functionals: {share:.1%} of {columns.sum():.0f} s in the loop. "
        f"Archive, pictures and figures at the end: {clock.parts['finish'][0]:.0f} s.",
    ]
    return "\n".join(lines)


@click.command()
@click.argument("task_id", metavar="[TASK]", default="LQD/Faucet-v0")
@click.option("--evaluations", type=click.IntRange(min=1), default=102_400, show_default=True)
@click.option("--seed", type=click.IntRange(min=0), default=100, show_default=True)
@click.option("--threads", type=click.IntRange(min=0), default=0, help="0: one for each CPU.")
def main(*, task_id: str, evaluations: int, seed: int, threads: int) -> None:
    """Run `ours`, checkpoints and all, and say where the time goes."""
    click.echo(table(measure(task_id, evaluations=evaluations, seed=seed, threads=threads)))


if __name__ == "__main__":
    main()
