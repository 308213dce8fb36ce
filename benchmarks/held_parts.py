"""Does `HeldPart` name what the pads touch? `python -m benchmarks.held_parts RUN...`."""

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import click
import mujoco
import numpy as np
from numpy.typing import NDArray

from benchmarks.tables.markdown import markdown_table
from lqd_envs import LQDError, Trajectories, rollout
from lqd_envs.instances import HeldPart
from lqd_envs.scene import Scene, load_scene
from lqd_envs.tasks.grasp import GRASP
from lqd_search.runs.run_folder import RunFolder

PARTS = ("handle", "rim", "body")
HANDLE, INSIDE, OUTSIDE, BOTTOM = "handle", "inside", "outside", "bottom"
_PADS = ("left_pad", "right_pad")
_OTHER = "several, or one pad alone"


def touched(scene: Scene, motions: Trajectories, row: int) -> tuple[frozenset[str], frozenset[str]]:
    """Return what of the mug each of the two pads touches at the end of a motion.

    Args:
        scene: The scene of the task.
        motions: Motions in it.
        row: Which of them; it was simulated.

    Returns:
        For the left and the right pad, which there are of `HANDLE`, `INSIDE`, `OUTSIDE` and
        `BOTTOM`; inside and outside are those of the wall.
    """
    model, data = scene.model, mujoco.MjData(scene.model)
    data.qpos[:] = scene.start_qpos(motions.plan.starts[row])
    mujoco.mj_forward(model, data)
    for action in motions.plan.actions[row]:
        data.ctrl[:] = scene.action_map.controls(action)
        mujoco.mj_step(model, data, nstep=scene.substeps)
    mujoco.mj_forward(model, data)
    mug = model.body("mug").id
    found: dict[int, set[str]] = {model.geom(name).id: set() for name in _PADS}
    for contact in data.contact:
        for pad, other in (contact.geom, contact.geom[::-1]):
            if pad in found and model.geom_bodyid[other] == mug:
                found[pad].add(_place(model, data, other, contact.pos))
    left, right = map(frozenset, found.values())
    return left, right


def part_touched(left: frozenset[str], right: frozenset[str]) -> str | None:
    """Return the part that the pads hold, or None where that is not one part alone."""
    if left == right == {HANDLE}:
        return "handle"
    if {left, right} == {frozenset({INSIDE}), frozenset({OUTSIDE})}:
        return "rim"
    if left == right == {OUTSIDE}:
        return "body"
    return None


def part_named(motions: Trajectories) -> list[str | None]:
    """Return for each motion the part that `HeldPart` says is held, or None."""
    held = np.stack([HeldPart(part).holds(motions.columns) for part in PARTS], axis=1)
    return [PARTS[row.argmax()] if row.any() else None for row in held]


def count_pairs(folder: Path, *, most: int, seed: int) -> Counter[tuple[str | None, str | None]]:
    """Count, among grasps of a run's archive, the pairs of what is touched and what is named.

    Args:
        folder: Of a finished run of grasp.
        most: How many of the elites that the expert approves are looked at, at random.
        seed: Seed of that choice.

    Raises:
        LQDError: There is no finished run, or it is one of another task.
    """
    run = RunFolder.open(folder)
    if run.config().task != GRASP.id:
        raise LQDError(
            f"Expected a run of {GRASP.id}, but {folder} is one of {run.config().task}; name "
            "others."
        )
    fields = run.archive().fields
    rows = np.flatnonzero(fields["expert"])
    rng = np.random.default_rng(seed)
    chosen = np.sort(rng.choice(rows, min(most, len(rows)), replace=False))
    motions = rollout(GRASP, fields["solution"][chosen])
    scene = load_scene(GRASP)
    named = part_named(motions)
    return Counter(
        (part_touched(*touched(scene, motions, row)), named[row])
        for row in np.flatnonzero(motions.success()).tolist()
    )


def describe(pairs: Counter[tuple[str | None, str | None]]) -> str:
    """Return the counts as a table."""
    columns = (*PARTS, None)
    rows = [
        [touching or _OTHER, *(str(pairs[touching, named]) for named in columns)]
        for touching in columns
    ]
    return markdown_table(["the pads touch", *(c or "none" for c in columns)], rows, words=1)


def _place(
    model: mujoco.MjModel, data: mujoco.MjData, geom: int, position: NDArray[np.float64]
) -> str:
    kind = mujoco.mjtGeom(int(model.geom_type[geom]))
    if kind != mujoco.mjtGeom.mjGEOM_BOX:
        return HANDLE if kind == mujoco.mjtGeom.mjGEOM_CAPSULE else BOTTOM
    # A wall is a box whose own x axis points outwards.
    outwards = data.geom_xmat[geom].reshape(3, 3)[:, 0] @ (position - data.geom_xpos[geom])
    return OUTSIDE if outwards > 0.0 else INSIDE


@click.command()
@click.argument("runs", metavar="RUN...", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option("--most", type=click.IntRange(min=1), default=90, show_default=True)
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True)
def main(*, runs: Sequence[Path], most: int, seed: int) -> None:
    """Compare, in finished runs of grasp, the part that is named with what the pads touch."""
    pairs: Counter[tuple[str | None, str | None]] = Counter()
    for folder in runs:
        pairs += count_pairs(folder, most=most, seed=seed)
    click.echo(describe(pairs))


if __name__ == "__main__":
    main()
