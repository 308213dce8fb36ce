"""`lqd replay`: one motion of an archive, once more."""

import sys
from pathlib import Path

import click
import numpy as np

from lqd_envs import LQDError, get_task
from lqd_envs.rendering_backend import has_display
from lqd_search.cli.video import check_video_path, write_video
from lqd_search.runs.replay import Replay, replay
from lqd_search.runs.run_config import RunConfig
from lqd_search.runs.run_folder import RunFolder
from lqd_search.runs.stored_archive import StoredArchive

_DIFFERENT = 1


@click.command("replay", short_help="Carry out a motion of an archive again.")
@click.argument("folder", metavar="DIR", type=click.Path(path_type=Path))
@click.option("--index", type=click.IntRange(min=0), help="Which elite, by its row in the archive.")
@click.option(
    "--best",
    is_flag=True,
    help="The success of the highest fitness, by the inferred condition.  [default]",
)
@click.option(
    "--video",
    type=click.Path(path_type=Path, dir_okay=False),
    help="Write a video (.mp4) instead of opening a window.",
)
def replay_command(*, folder: Path, index: int | None, best: bool, video: Path | None) -> None:
    """Carry out a motion of the archive in DIR, step by step in the Gymnasium env.

    With a display it is shown in a window; without one, only what it came to is printed. Either
    way it is compared, bit for bit, with what the search saw; where it differs, the exit status
    is 1.
    """
    if best and index is not None:
        raise LQDError("Expected --index or --best, got both; leave one out.")
    run = RunFolder.open(folder)
    config, archive = run.config(), run.archive()
    task = get_task(config.task)
    row = best_success(archive) if index is None else _checked_index(archive, index)
    if video:
        check_video_path(video)
    mode = "rgb_array" if video else "human" if has_display() else None
    shown = replay(task.id, archive.fields["solution"][row], render_mode=mode)
    if video:
        write_video(video, shown.frames)
    click.echo(_report(archive, row, shown))
    if video:
        click.echo(f"video: {video}")
    if not is_same(archive, row, shown):
        click.echo(f"lqd: {difference(config)}", err=True)
        sys.exit(_DIFFERENT)


def best_success(archive: StoredArchive) -> int:
    """Return the row of the success of the highest fitness, by the inferred condition.

    Raises:
        LQDError: The archive holds no success.
    """
    success = archive.fields["success"]
    if not success.any():
        raise LQDError(
            f"Expected a success in the archive, but none of its {len(archive)} elites is one by "
            "the inferred condition; choose an elite with --index, or search longer."
        )
    return int(np.argmax(np.where(success, archive.fields["objective"], -np.inf)))


def is_same(archive: StoredArchive, row: int, shown: Replay) -> bool:
    """Return whether a replay is, bit for bit, what the run saw of that row of its archive."""
    fields = archive.fields
    same_infos = shown.same_as_batch and shown.digest == int(fields["digest"][row])
    return same_infos and shown.success == bool(fields["expert"][row])


def difference(config: RunConfig) -> str:
    """Return a sentence that says which versions may have made a replay another motion."""
    changed = config.changed_versions()
    versions = ", ".join(f"{name} {ran} (here {here})" for name, (ran, here) in changed.items())
    why = (
        f"the run was made with other versions, {versions}; install these to see it again."
        if changed
        else "none of the versions in config.json differs from those here; another processor or a "
        "changed task or archive may be why."
    )
    return f"Expected the motion that the run saw, but this replay differs from it: {why}"


def _checked_index(archive: StoredArchive, index: int) -> int:
    if index >= len(archive):
        raise LQDError(
            f"Expected an index below {len(archive)}, the number of elites in the archive, got "
            f"{index}."
        )
    return index


def _report(archive: StoredArchive, row: int, shown: Replay) -> str:
    fields = archive.fields
    expert, digest = bool(fields["expert"][row]), int(fields["digest"][row])
    end = shown.infos[-1]
    lines = [
        f"elite {row} of {len(archive)}, evaluation {fields['evaluation'][row]}, "
        f"fitness {fields['objective'][row]:.6g}",
        f"solution: {np.array2string(fields['solution'][row], precision=4, separator=', ')}",
        f"success: {_yes(shown.success)} by the expert's condition (in the run: {_yes(expert)}; "
        f"by the inferred one: {_yes(bool(fields['success'][row]))})",
        f"infos equal to a batch rollout's, bit for bit: {_yes(shown.same_as_batch)}",
        f"infos equal to those of the run, bit for bit: {_yes(shown.digest == digest)}",
        "at the end: "
        + ", ".join(
            [
                *(f"{name} {value:.4f}" for name, value in end["joint_positions"].items()),
                "gripper at "
                + np.array2string(np.asarray(end["gripper_position"]), precision=3, separator=", "),
            ]
        ),
    ]
    return "\n".join(lines)


def _yes(value: bool) -> str:
    return "yes" if value else "no"
