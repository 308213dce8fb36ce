"""What becomes of uniform random solutions: `python -m benchmarks.random_solutions TASK`."""

from collections import Counter

import click
import numpy as np
from scipy.stats import binomtest

from lqd_envs import SolutionSpace, Trajectories, Verdict, get_task, rollout
from lqd_envs.tasks.task import Task

_BATCH = 2_000


def count_verdicts(task: Task, *, solutions: int, seed: int) -> tuple[Counter[Verdict], int]:
    """Simulate uniform random solutions and count what became of them.

    Args:
        task: The task.
        solutions: How many.
        seed: Seed of the solutions.

    Returns:
        How many got each verdict, and how many were successful by the expert's condition.
    """
    rng = np.random.default_rng(seed)
    verdicts: Counter[Verdict] = Counter()
    successes = 0
    # Drawn at once, so that every command speaks of the same solutions for the same seed.
    drawn = SolutionSpace().sample(solutions, rng=rng)
    for batch in np.split(drawn, range(_BATCH, solutions, _BATCH)):
        trajectories: Trajectories = rollout(task, batch)
        verdicts.update(Verdict(int(verdict)) for verdict in trajectories.verdicts)
        successes += int(trajectories.success().sum())
    return verdicts, successes


def table(verdicts: Counter[Verdict], successes: int) -> str:
    """Return the counts as a Markdown table, with the 95 % interval of the success share."""
    total = sum(verdicts.values())
    groups = {
        "unreachable": verdicts[Verdict.UNREACHABLE],
        "overlapping": verdicts[Verdict.OVERLAPPING],
        "discarded": sum(count for verdict, count in verdicts.items() if verdict.discarded),
        "valid": verdicts[Verdict.VALID],
        "successful": successes,
    }
    causes = ", ".join(
        f"{verdicts[verdict]:,} {verdict.name.lower().replace('_', ' ')}"
        for verdict in Verdict
        if verdict.discarded
    )
    interval = binomtest(successes, total).proportion_ci(method="wilson")
    lines = ["| | count | share |", "|---|---:|---:|"]
    lines += [f"| {name} | {count:,} | {count / total:.2%} |" for name, count in groups.items()]
    lines += [
        f"| all | {total:,} | 100 % |",
        "",
        f"Successful, 95 % interval: {interval.low:.2%} to {interval.high:.2%} of all. "
        f"Discarded: {causes}.",
    ]
    return "\n".join(lines)


@click.command()
@click.argument("task_id", metavar="TASK")
@click.option("--solutions", type=click.IntRange(min=1), default=20_000, show_default=True)
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True)
def main(*, task_id: str, solutions: int, seed: int) -> None:
    """Count what becomes of uniform random solutions in TASK."""
    click.echo(table(*count_verdicts(get_task(task_id), solutions=solutions, seed=seed)))


if __name__ == "__main__":
    main()
