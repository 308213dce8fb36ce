"""How the physics step changes outcomes: `python -m benchmarks.physics_step TASK`."""

import time
from dataclasses import dataclass

import click
import numpy as np
from numpy.typing import NDArray

from lqd_envs import SolutionSpace, Trajectories, get_task
from lqd_envs.motion import plan_in_scene
from lqd_envs.rollout import simulate
from lqd_envs.scene import load_scene
from lqd_envs.tasks.task import Task

REFERENCE = 0.001
"""The physics step, in s, that the others are compared with."""
STEPS = (0.004, 0.02 / 6, 0.0025, 0.002)


@dataclass(frozen=True)
class Comparison:
    """How the outcomes with one physics step compare with those at 1 ms.

    Attributes:
        step: Physics step in s.
        touching: Motions, valid at 1 ms, that touch a moving link of the object.
        agreement: Share of these whose success is the same.
        successes: Successes with this step.
        surviving: Share of them that are successes at 1 ms too.
        found: Share of the successes at 1 ms that are successes with this step too.
        discarded: Simulated motions that were discarded.
        milliseconds: Time for each simulated motion, in ms.
    """

    step: float
    touching: int
    agreement: float
    successes: int
    surviving: float
    found: float
    discarded: int
    milliseconds: float


def compare(task: Task, *, solutions: NDArray[np.float64]) -> list[Comparison]:
    """Simulate the same motions with each physics step."""
    plan = plan_in_scene(load_scene(task), solutions)

    def run(step: float) -> tuple[Trajectories, float]:
        began = time.perf_counter()
        trajectories = simulate(load_scene(task, physics_step=step), solutions, plan)
        elapsed = time.perf_counter() - began
        return trajectories, 1e3 * elapsed / int(trajectories.simulated.sum())

    reference, milliseconds = run(REFERENCE)
    rows = [_row(REFERENCE, reference, reference, milliseconds)]
    for step in STEPS:
        trajectories, milliseconds = run(step)
        rows.append(_row(step, trajectories, reference, milliseconds))
    return rows


def _row(step: float, got: Trajectories, reference: Trajectories, ms: float) -> Comparison:
    moving = len(reference.task.schema.joints) or len(reference.task.schema.links)
    contacts = reference.columns.gripper_contacts[:, :, -moving:].any(axis=(1, 2))
    touching = contacts & reference.valid
    success, expected = got.success(), reference.success()
    return Comparison(
        step=step,
        touching=int(touching.sum()),
        agreement=float((success == expected)[touching].mean()),
        successes=int(success.sum()),
        surviving=float(expected[success].mean()),
        found=float(success[expected].mean()),
        discarded=int((got.simulated & ~got.valid).sum()),
        milliseconds=ms,
    )


@click.command()
@click.argument("task_id", metavar="TASK")
@click.option("--solutions", type=click.IntRange(min=1), default=20_000, show_default=True)
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True)
def main(*, task_id: str, solutions: int, seed: int) -> None:
    """Compare physics steps on the same uniform random motions of TASK."""
    batch = SolutionSpace().sample(solutions, rng=np.random.default_rng(seed))
    rows = compare(get_task(task_id), solutions=batch)
    click.echo(f"{rows[0].touching} valid motions touch a moving link.\n")
    click.echo(
        "| step (ms) | same success | successes | still at 1 ms | of those at 1 ms "
        "| discarded | ms a motion |"
    )
    click.echo("|---:|---:|---:|---:|---:|---:|---:|")
    for row in rows:
        click.echo(
            f"| {1e3 * row.step:.2f} | {row.agreement:.1%} | {row.successes} | {row.surviving:.0%} "
            f"| {row.found:.0%} | {row.discarded} | {row.milliseconds:.1f} |"
        )


if __name__ == "__main__":
    main()
