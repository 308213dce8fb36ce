"""What calling functionals in the sandbox costs: `python -m benchmarks.functionals [TASK...]`.

A recording's functionals judge the same motions in the sandbox and in this process, in turns, since
a machine's speed drifts; what counts are medians over the rounds. What is measured is CPU time,
user and system: of this process, which copies the columns and reads the results, with
`time.process_time`, and of the sandbox's worker by the kernel's clock of that process, which needs
Linux. What starting the worker takes is not counted.
"""

import time
from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass

import click
import numpy as np
from numpy.typing import NDArray

from benchmarks.plain_functions import plain_functionals
from benchmarks.recorded_recipe import recorded_functionals
from lqd_envs import PAPER_TASKS, LQDError, SolutionSpace, Task, Trajectories, get_task, rollout
from lqd_llm.sandbox import Sandbox
from lqd_search import FunctionalEvaluator, Values
from lqd_search.cli.evaluator_recipe import EvaluatorRecipe
from lqd_search.cli.opened_sandbox import open_sandbox
from lqd_search.cli.sandbox_judge import SandboxMeshJudge
from lqd_search.evaluation.judge import Judge
from lqd_search.evaluation.mesh_judge import MeshJudge
from lqd_search.methods.steering import MESH
from lqd_search.runs.function_text import FunctionText

BAR_MILLISECONDS = 0.6
"""CPU time that a motion may take in the sandbox, in ms."""
BAR_RATIO = 1.25
"""What it may be of the time that it takes in this process."""

_BATCH = 512


@dataclass(frozen=True, eq=False)
class Costs:
    """What one motion costs, a row for each round.

    Attributes:
        task: The task.
        motions: Motions in a round.
        here: (rounds,) CPU time in ms when the functionals are called in this process.
        host: (rounds,) CPU time in ms of this process when they run in the sandbox.
        worker: (rounds,) CPU time in ms of the sandbox's worker.
    """

    task: Task
    motions: int
    here: NDArray[np.float64]
    host: NDArray[np.float64]
    worker: NDArray[np.float64]

    @property
    def sandbox(self) -> NDArray[np.float64]:
        """(rounds,) CPU time in ms of both processes."""
        return self.host + self.worker

    @property
    def ratio(self) -> float:
        """Median over the rounds of the sandbox's time over that of this process."""
        return float(np.median(self.sandbox / self.here))


def valid_motions(task: Task, *, n: int, seed: int) -> Trajectories:
    """Simulate uniform random solutions until there are `n` valid ones, and return the motions."""
    rng, found = np.random.default_rng(seed), np.empty((0, SolutionSpace().dim))
    while len(found) < n:
        solutions = SolutionSpace().sample(_BATCH, rng=rng)
        found = np.concatenate([found, solutions[rollout(task, solutions).valid]])
    return rollout(task, found[:n])


def measure(motions: Trajectories, *, sample: int, rounds: int) -> Costs:
    """Judge the same motions by a recording's mesh here and in the sandbox, in turns.

    Args:
        motions: Valid ones.
        sample: Which recorded sample of the model's replies.
        rounds: How often each judges them, after a first time that is not counted.

    Raises:
        LQDError: The two do not give the same values.
    """
    task = motions.task
    checked = recorded_functionals(task, sample=sample)
    recipe = EvaluatorRecipe.of(
        task.id, steering=MESH, functions=checked.texts, lengths=checked.lengths
    )
    here = judge_here(motions, functions=recipe.functions)
    sandbox = open_sandbox(task.schema, recipe.functions)
    if sandbox is None:
        raise LQDError("Expected functions to call, but there are none; name another sample.")
    with closing(sandbox):
        there = SandboxMeshJudge(sandbox, functions=recipe.functions, lengths=checked.lengths)
        _require_same(there(motions), here(motions))
        seconds = np.empty((3, rounds))
        for i in range(rounds):
            # Whoever comes first warms the caches for the other.
            for judge in (here, there) if i % 2 else (there, here):
                host, worker = cpu_seconds(judge, motions, sandbox)
                if judge is here:
                    seconds[0, i] = host
                else:
                    seconds[1:, i] = host, worker
    return Costs(task, len(motions), *(seconds / len(motions) * 1e3))


def judge_here(motions: Trajectories, *, functions: Sequence[FunctionText]) -> MeshJudge:
    """Return what judges by a recording's mesh in this process."""
    functionals = plain_functionals(functions)
    return MeshJudge(FunctionalEvaluator(functionals, examples=motions.infos(0)))


def cpu_seconds(judge: Judge, motions: Trajectories, sandbox: Sandbox) -> tuple[float, float]:
    """Judge, and return the CPU time in s that this process and the sandbox's worker took.

    Raises:
        LQDError: The worker was replaced meanwhile.
    """
    pid = sandbox.worker_pid
    began, worker_began = time.process_time(), _clock(pid)
    judge(motions)
    ended, worker_ended = time.process_time(), _clock(pid)
    if sandbox.worker_pid != pid:
        raise LQDError("Expected one worker to judge all motions, but it was replaced; run again.")
    return ended - began, worker_ended - worker_began


def table(costs: Sequence[Costs]) -> str:
    """Return the medians as a Markdown table."""
    lines = [
        "| task | motions | here, ms | sandbox, ms | of it host | of it worker | ratio |",
        "|---|---:|---:|---:|---:|---:|---:|",
    ]
    for cost in costs:
        parts = (cost.here, cost.sandbox, cost.host, cost.worker)
        medians = " | ".join(f"{np.median(part):.3f}" for part in parts)
        lines.append(f"| {cost.task.name} | {cost.motions} | {medians} | {cost.ratio:.2f} |")
    slowest = max(float(np.median(cost.sandbox)) for cost in costs)
    ratio = max(cost.ratio for cost in costs)
    lines += [
        "",
        f"Most CPU time of a motion in the sandbox: {slowest:.2f} ms, bar {BAR_MILLISECONDS} ms. "
        f"Highest ratio: {ratio:.2f}, bar {BAR_RATIO}.",
    ]
    return "\n".join(lines)


def _clock(pid: int | None) -> float:
    if pid is None:
        raise LQDError("Expected the sandbox to have a worker, but it has none; run again.")
    # The clock of another process, as clock_getcpuclockid(3) makes it.
    return time.clock_gettime((~pid << 3) | 2)


def _require_same(values: Values, expected: Values) -> None:
    columns = {**values.fitness, **values.measures, "": values.success}
    for name, column in {**expected.fitness, **expected.measures, "": expected.success}.items():
        if columns[name].tobytes() != column.tobytes():
            raise LQDError(
                f"Expected the same values in the sandbox as here, but {name or 'success'!r} "
                "differs; run the tests of the sandbox."
            )


@click.command()
@click.argument("task_ids", metavar="[TASK]...", nargs=-1)
@click.option("--sample", type=click.IntRange(min=0), default=0, show_default=True)
@click.option("--motions", type=click.IntRange(min=1), default=256, show_default=True)
@click.option("--rounds", type=click.IntRange(min=1), default=9, show_default=True)
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True)
def main(*, task_ids: tuple[str, ...], sample: int, motions: int, rounds: int, seed: int) -> None:
    """Compare a recording's functionals in the sandbox with the same in this process."""
    tasks = [get_task(task_id) for task_id in task_ids] or list(PAPER_TASKS)
    click.echo(
        table(
            [
                measure(valid_motions(task, n=motions, seed=seed), sample=sample, rounds=rounds)
                for task in tasks
            ]
        )
    )


if __name__ == "__main__":
    main()
