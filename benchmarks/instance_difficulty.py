"""How hard are task instances for random successes? `python -m benchmarks.instance_difficulty`."""

from collections.abc import Sequence

import click
import numpy as np
from numpy.typing import NDArray

from benchmarks.random_trajectories import random_trajectories
from benchmarks.tables.markdown import markdown_table
from lqd_envs import SolutionSpace, Task, rollout
from lqd_envs.instances import KINDS, Instance, generate_instances
from lqd_envs.tasks.registry import PAPER_TASKS


def random_successes(task: Task, *, count: int, most: int, seed: int) -> NDArray[np.float64]:
    """Return the first successes among uniform random solutions.

    Args:
        task: The task, whose expert says what a success is.
        count: How many to find.
        most: Solutions after which to stop, whatever was found.
        seed: Seed of the solutions.

    Returns:
        (n, 9) solutions, n at most `count`.
    """
    found = np.empty((0, SolutionSpace().dim))
    for motions in random_trajectories(task, most=most, rng=np.random.default_rng(seed)):
        found = np.concatenate([found, motions.solutions[motions.success()]])
        if len(found) >= count:
            break
    return found[:count]


def shares_solved(
    task: Task, solutions: NDArray[np.float64], instances: Sequence[Instance]
) -> NDArray[np.float64]:
    """Return which share of motions solves each instance, simulated in it.

    Args:
        task: The task.
        solutions: (n, 9) solutions, n at least 1.
        instances: m instances of the task.

    Returns:
        (m,) shares.
    """
    solved = [rollout(instance.apply(task), solutions).success().mean() for instance in instances]
    return np.array(solved)


def _row(task: Task, kind: str, shares: NDArray[np.float64], *, motions: int) -> tuple[str, ...]:
    low, median, high = np.percentile(shares, [25, 50, 75])
    return (
        task.name,
        kind,
        str(motions),
        f"{int((shares > 0).sum())} of {len(shares)}",
        str(int((shares == 1).sum())),
        f"{median:.0%} ({low:.0%} to {high:.0%})",
    )


@click.command()
@click.option("--count", type=click.IntRange(min=1), default=20, show_default=True)
@click.option("--successes", type=click.IntRange(min=1), default=60, show_default=True)
@click.option("--most", type=click.IntRange(min=1), default=400_000, show_default=True)
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True)
def main(*, count: int, successes: int, most: int, seed: int) -> None:
    """Try random successes in the first drawn instances (of seed 0) of each task and kind."""
    rows = []
    for task in PAPER_TASKS:
        solutions = random_successes(task, count=successes, most=most, seed=seed)
        for kind in KINDS if len(solutions) else ():
            instances = generate_instances(task, kind, count=count, seed=0)
            shares = shares_solved(task, solutions, instances)
            rows.append(_row(task, kind, shares, motions=len(solutions)))
    head = (
        *("task", "kind", "motions tried", "solved by at least one", "by all"),
        "share of motions, median (quartiles)",
    )
    click.echo(markdown_table(head, rows, words=2))


if __name__ == "__main__":
    main()
