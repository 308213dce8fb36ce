"""Choose each task's example motions: `python -m benchmarks.example_motions`."""

import json
from pathlib import Path

import click
import numpy as np
from numpy.typing import NDArray

from lqd_envs import PAPER_TASKS, SolutionSpace, Trajectories, rollout
from lqd_envs.tasks import examples

_SEED = 1
_SOLUTIONS = 8_192
_MOVING, _TOUCHING = 16, 8


def moved(trajectories: Trajectories) -> NDArray[np.float64]:
    """Return how far each motion moved the object: its base in m, and its joints in their units."""
    columns = trajectories.columns
    base = np.linalg.norm(columns.object_position - columns.object_position[:, :1], axis=2)
    joints = np.abs(columns.joint_positions - columns.joint_positions[:, :1])
    both = np.concatenate([base[:, :, None], joints], axis=2)
    return np.asarray(both.max(axis=(1, 2)))


def choose(trajectories: Trajectories) -> NDArray[np.intp]:
    """Choose valid motions: those that moved the object farthest, then the first that touched it.

    The expert's verdict plays no part.
    """
    valid = np.flatnonzero(trajectories.valid)
    touching = np.any(trajectories.columns.gripper_contacts, axis=(1, 2))
    farthest = valid[np.argsort(-moved(trajectories)[valid], kind="stable")][:_MOVING]
    others = [row for row in valid if touching[row] and row not in farthest]
    return np.concatenate([farthest, np.array(others[:_TOUCHING], np.intp)])


@click.command()
def main() -> None:
    """Simulate random solutions of every task, and write those that were chosen."""
    for task in PAPER_TASKS:
        solutions = SolutionSpace().sample(_SOLUTIONS, rng=np.random.default_rng(_SEED))
        chosen = choose(rollout(task, solutions))
        path = Path(examples.__file__).with_name("examples") / f"{task.name}.json"
        path.write_text(json.dumps(solutions[chosen].tolist(), indent=1) + "\n")
        click.echo(f"{task.id}: {len(chosen)} motions")


if __name__ == "__main__":
    main()
