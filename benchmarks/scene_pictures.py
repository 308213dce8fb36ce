"""Pictures of the tasks for the docs: `python -m benchmarks.scene_pictures`."""

from pathlib import Path

import click
import imageio.v3 as iio
import numpy as np

from lqd_envs import PAPER_TASKS, SolutionSpace, rollout
from lqd_envs.tasks.task import Task
from lqd_search.runs.replay import replay


def picture_task(task: Task, *, folder: Path, seed: int, solutions: int) -> tuple[Path, Path]:
    """Draw a task at its start and during a success found among random solutions.

    Args:
        task: The task.
        folder: Where to write `<task>-start.png` and `<task>-success.png`.
        seed: Seed of the solutions.
        solutions: Solutions to draw at a time, until one is successful.

    Returns:
        The two files.
    """
    rng = np.random.default_rng(seed)
    while True:
        batch = rollout(task, SolutionSpace().sample(solutions, rng=rng))
        successes = np.flatnonzero(batch.success())
        if len(successes):
            break
    # The one that moved the object furthest shows most.
    columns = batch.columns
    way = np.linalg.norm(
        columns.object_position[successes, -1] - columns.object_position[successes, 0], axis=1
    ) + np.abs(columns.joint_positions[successes, -1]).sum(axis=1)
    best = successes[np.argmax(way)]
    frames = replay(task.id, batch.solutions[best], render_mode="rgb_array").frames
    start, success = folder / f"{task.name}-start.png", folder / f"{task.name}-success.png"
    iio.imwrite(start, frames[0])
    iio.imwrite(success, frames[-1])
    return start, success


@click.command()
@click.option("--folder", type=click.Path(path_type=Path), default=Path("docs/images"))
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True)
@click.option("--solutions", type=click.IntRange(min=1), default=4_000, show_default=True)
def main(*, folder: Path, seed: int, solutions: int) -> None:
    """Draw every task at its start and at the end of a success."""
    folder.mkdir(parents=True, exist_ok=True)
    for task in PAPER_TASKS:
        for path in picture_task(task, folder=folder, seed=seed, solutions=solutions):
            click.echo(path)


if __name__ == "__main__":
    main()
