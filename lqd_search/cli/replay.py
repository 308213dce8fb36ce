"""`lqd replay`: one motion of an archive, once more."""

from pathlib import Path

import click
import numpy as np

from lqd_envs import LQDError, get_task
from lqd_envs.rendering_backend import has_display
from lqd_search.replay import Replay, replay
from lqd_search.run_folder import RunFolder
from lqd_search.stored_archive import StoredArchive


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
    way it is compared, bit for bit, with what the search saw.
    """
    if best and index is not None:
        raise LQDError("Expected --index or --best, got both; leave one out.")
    run = RunFolder.open(folder)
    archive, task = run.archive(), get_task(run.config().task)
    row = best_success(archive) if index is None else _checked_index(archive, index)
    _check_video(video)
    mode = "rgb_array" if video else "human" if has_display() else None
    shown = replay(task.id, archive.fields["solution"][row], render_mode=mode)
    if video:
        _write_video(video, shown)
    click.echo(_report(archive, row, shown))
    if video:
        click.echo(f"video: {video}")


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


def _checked_index(archive: StoredArchive, index: int) -> int:
    if index >= len(archive):
        raise LQDError(
            f"Expected an index below {len(archive)}, the number of elites in the archive, got "
            f"{index}."
        )
    return index


def _check_video(video: Path | None) -> None:
    if video is None:
        return
    if video.suffix != ".mp4":
        raise LQDError(f"Expected the name of an .mp4 file for the video, got {video}.")
    if video.exists() or not video.absolute().parent.is_dir():
        why = "exists already" if video.exists() else "is in a folder that does not exist"
        raise LQDError(f"Expected a new file for the video, but {video} {why}; choose another.")


def _write_video(video: Path, shown: Replay) -> None:
    import imageio.v3 as iio

    part = video.with_name(f".{video.stem}.part.mp4")
    # yuv420p and even sizes: what every player and browser can show.
    iio.imwrite(part, np.stack(shown.frames), fps=50, codec="libx264")
    part.replace(video)


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
