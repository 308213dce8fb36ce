"""How do inferred success conditions judge the same motions? `python -m benchmarks.conditions`.

Each recording has two: the one that the model wrote on its own, which steers `ours`, and the one
that it wrote together with a fitness and a descriptor, which steers `direct`. In finished runs each
judges the motions of its own search; here all judge the same random ones.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence

import click
import numpy as np
from numpy.typing import NDArray

from benchmarks.random_trajectories import random_trajectories
from benchmarks.recorded_recipe import recorded_functionals
from benchmarks.tables.cell import RECORDINGS
from benchmarks.tables.cell_figures import Verdicts
from benchmarks.tables.markdown import markdown_table
from benchmarks.tables.measures import precision, recall
from lqd_envs import PAPER_TASKS, Task, Trajectories, get_task
from lqd_llm import perception_layout
from lqd_llm.sandbox import Role, Sandbox, SandboxedFunction, check_source
from lqd_search.methods.steering import DIRECT, MESH

_STEERS = {"success": MESH, "direct.success": DIRECT}


def recorded_conditions(task: Task) -> Iterator[SandboxedFunction]:
    """Make the success conditions of all recordings of a task, as the sandbox takes them.

    Yields:
        For each recording k those called `mesh_k` and `direct_k`.
    """
    for k in range(RECORDINGS):
        for text in recorded_functionals(task, sample=k).texts:
            if text.kind in _STEERS:
                source = check_source(text.code, entry=text.entry)
                yield SandboxedFunction(f"{_STEERS[text.kind]}_{k}", Role.SUCCESS, source)


def judge(
    task: Task, motions: Iterable[Trajectories], conditions: Sequence[SandboxedFunction]
) -> Mapping[str, Verdicts]:
    """Count what conditions approve of valid motions, beside the expert.

    Args:
        task: The task.
        motions: Batches of motions of it, at least one.
        conditions: The conditions, which ship with the package: a sandbox will do that lacks layers
            which this system does not have.

    Returns:
        The counts of each, by its name.
    """
    approved: dict[str, list[NDArray[np.bool_]]] = {one.name: [] for one in conditions}
    expert = []
    layout = perception_layout(task.schema)
    with Sandbox(layout, functions=conditions, allow_weak=True) as sandbox:
        for batch in motions:
            rows = np.flatnonzero(batch.valid)
            expert.append(batch.success()[rows])
            results = sandbox.run(batch.columns.rows(rows).arrays(), lengths={})
            for name, parts in approved.items():
                parts.append(results.success[name])
    together = np.concatenate(expert)
    return {name: Verdicts.of(np.concatenate(parts), together) for name, parts in approved.items()}


def describe(task: Task, found: Mapping[str, Verdicts]) -> list[tuple[str, ...]]:
    """Return a row for each recording."""
    rows = []
    for k in range(RECORDINGS):
        pair = [found[f"{steering}_{k}"] for steering in (MESH, DIRECT)]
        successes = pair[0].both + pair[0].expert_only
        figures = (f"{score(one):.2f}" for one in pair for score in (recall, precision))
        rows.append((task.name, str(k), str(successes), *figures))
    return rows


@click.command()
@click.argument("tasks", metavar="[TASK]...", nargs=-1)
@click.option("--motions", type=click.IntRange(min=1), default=20_480, show_default=True)
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True)
def main(*, tasks: Sequence[str], motions: int, seed: int) -> None:
    """Judge the same random motions by all recorded success conditions of tasks."""
    rows = []
    for task in map(get_task, tasks) if tasks else PAPER_TASKS:
        batches = random_trajectories(task, most=motions, rng=np.random.default_rng(seed))
        rows += describe(task, judge(task, batches, list(recorded_conditions(task))))
    head = (
        *("task", "recording", "expert's successes", "recall of `mesh`", "precision"),
        *("recall of `direct`", "precision"),
    )
    click.echo(markdown_table(head, rows, words=1))


if __name__ == "__main__":
    main()
