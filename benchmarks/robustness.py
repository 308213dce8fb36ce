"""Do successes survive finer physics and small shifts? `python -m benchmarks.robustness TASK`."""

from collections.abc import Iterator
from dataclasses import dataclass

import click
import numpy as np
from mujoco.batch import Batch
from numpy.typing import NDArray

from benchmarks.random_trajectories import random_trajectories
from lqd_envs import Trajectories, get_task
from lqd_envs.rollout import PrepareBatch, simulate
from lqd_envs.scene import Scene, load_scene
from lqd_envs.tasks.task import Task

FINE_STEP = 0.001
"""Physics step that outcomes are compared with, in s."""
SHIFT = 0.001
"""How far the object is moved, in m."""
TOPPLED = np.deg2rad(45.0)
"""Tilt from which on a free object counts as toppled, in rad."""


@dataclass(frozen=True)
class Robustness:
    """What becomes of random successes and of random motions that touch the object.

    Attributes:
        solutions: Random solutions drawn until there were enough successes.
        successes: Successes among them that were simulated again.
        at_fine_step: How many of these are successes with a physics step of 1 ms.
        shifted: How many are successes with the object moved by 1 mm.
        toppled: How many end with a toppled object.
        touching: Random valid motions that touch the object, simulated again with 1 ms.
        agreeing: How many of these have the same success.
    """

    solutions: int
    successes: int
    at_fine_step: int
    shifted: int
    toppled: int
    touching: int
    agreeing: int


def measure(task: Task, *, successes: int, touching: int, most: int, seed: int) -> Robustness:
    """Draw random solutions until there are enough successes, and simulate them again.

    Args:
        task: The task.
        successes: How many successes to find.
        touching: How many motions that touch the object to compare.
        most: Solutions after which to stop, whatever was found.
        seed: Seed of the solutions and of the shifts.
    """
    rng = np.random.default_rng(seed)
    found: list[Trajectories] = []
    touched: list[Trajectories] = []
    drawn = 0
    for batch in random_trajectories(task, most=most, rng=rng):
        drawn += len(batch)
        found.append(batch.rows(np.flatnonzero(batch.success())))
        touched.append(batch.rows(np.flatnonzero(_touches(batch) & batch.valid)))
        if _count(found) >= successes:
            break
    scene, fine = load_scene(task), load_scene(task, physics_step=FINE_STEP)
    chosen = list(_first(found, successes))
    compared = list(_first(touched, touching))
    shift = _shift(scene, rng=rng)
    return Robustness(
        solutions=drawn,
        successes=_count(chosen),
        at_fine_step=sum(int(_again(fine, part).success().sum()) for part in chosen),
        shifted=sum(int(_again(scene, part, shift).success().sum()) for part in chosen),
        toppled=sum(int(_toppled(part).sum()) for part in chosen),
        touching=_count(compared),
        agreeing=sum(
            int((_again(fine, part).success() == part.success()).sum()) for part in compared
        ),
    )


def _again(
    scene: Scene, trajectories: Trajectories, prepare: PrepareBatch | None = None
) -> Trajectories:
    return simulate(scene, trajectories.solutions, trajectories.plan, prepare=prepare)


def _shift(scene: Scene, *, rng: np.random.Generator) -> PrepareBatch:
    """Return what moves the object of each simulation in a random horizontal direction."""
    base = scene.model.body(scene.task.base)

    def prepare(batch: Batch, rows: NDArray[np.intp]) -> None:
        angle = rng.uniform(-np.pi, np.pi, len(rows))
        offset = SHIFT * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        if base.dofnum[0]:
            start = scene.model.jnt_qposadr[base.jntadr[0]]
            batch.bind("qpos")[:, start : start + 2] += offset
        else:
            batch.expand("body_pos")[:, base.id, :2] += offset

    return prepare


def _touches(trajectories: Trajectories) -> NDArray[np.bool_]:
    return np.asarray(trajectories.columns.gripper_contacts.any(axis=(1, 2)))


def _toppled(trajectories: Trajectories) -> NDArray[np.bool_]:
    roll, pitch, _ = trajectories.columns.object_orientation[:, -1].T
    return np.asarray(np.cos(roll) * np.cos(pitch) < np.cos(TOPPLED))


def _count(parts: list[Trajectories]) -> int:
    return sum(len(part) for part in parts)


def _first(parts: list[Trajectories], n: int) -> Iterator[Trajectories]:
    for part in parts:
        if n and len(part):
            yield part.rows(np.arange(min(n, len(part))))
            n -= min(n, len(part))


@click.command()
@click.argument("task_id", metavar="TASK")
@click.option("--successes", type=click.IntRange(min=1), default=200, show_default=True)
@click.option("--touching", type=click.IntRange(min=1), default=200, show_default=True)
@click.option("--most", type=click.IntRange(min=1), default=200_000, show_default=True)
@click.option("--seed", type=click.IntRange(min=0), default=1, show_default=True)
def main(*, task_id: str, successes: int, touching: int, most: int, seed: int) -> None:
    """Simulate random successes of TASK again, with finer physics and a shifted object."""
    result = measure(
        get_task(task_id), successes=successes, touching=touching, most=most, seed=seed
    )
    click.echo("| | count | share |\n|---|---:|---:|")
    rows = (
        ("successes among random solutions", result.successes, result.solutions),
        ("still successes at 1 ms", result.at_fine_step, result.successes),
        ("still successes with the object moved by 1 mm", result.shifted, result.successes),
        ("successes with a toppled object", result.toppled, result.successes),
        ("touching motions with the same outcome at 1 ms", result.agreeing, result.touching),
    )
    for name, count, of in rows:
        share = f"{count / of:.2%}" if of else "-"
        click.echo(f"| {name} | {count:,} of {of:,} | {share} |")


if __name__ == "__main__":
    main()
