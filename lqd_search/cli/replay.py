"""`lqd replay`: one motion of a run, once more."""

import sys
from pathlib import Path

import click

from lqd_envs import LQDError, get_task
from lqd_envs.rendering_backend import has_display
from lqd_search.cli.stored_motion import StoredMotion, best_success
from lqd_search.cli.video import check_video_path, write_video
from lqd_search.runs.replay import replay
from lqd_search.runs.run_config import RunConfig
from lqd_search.runs.run_folder import RunFolder

_DIFFERENT = 1


@click.command("replay")
@click.argument("folder", metavar="DIR", type=click.Path(path_type=Path))
@click.option("--index", type=click.IntRange(min=0), help="Which elite, by its row in the archive.")
@click.option(
    "--best",
    is_flag=True,
    help="The success of the highest fitness, by the inferred condition.  [default]",
)
@click.option(
    "--outcome",
    type=click.IntRange(min=0),
    help="Which of all distinct successes of the run, by its row in outcomes.npz.",
)
@click.option(
    "--video",
    type=click.Path(path_type=Path, dir_okay=False),
    help="Write a video (.mp4) instead of opening a window.",
)
def replay_command(
    *, folder: Path, index: int | None, best: bool, outcome: int | None, video: Path | None
) -> None:
    """Carry out a motion of the run in DIR, step by step in the Gymnasium env.

    With a display it is shown in a window; without one, only what it came to is printed. Either
    way it is compared, bit for bit, with what the search saw; where it differs, the exit status
    is 1.
    """
    _refuse_two_choices(index=index, best=best, outcome=outcome)
    run = RunFolder.open(folder)
    config = run.config()
    task = get_task(config.task)
    motion = _chosen(run, index=index, outcome=outcome)
    if video:
        check_video_path(video)
    mode = "rgb_array" if video else "human" if has_display() else None
    shown = replay(task.id, motion.solution, render_mode=mode)
    if video:
        write_video(video, shown.frames)
    click.echo(motion.report(shown))
    if video:
        click.echo(f"video: {video}")
    if not motion.is_same(shown):
        click.echo(f"lqd: {difference(config)}", err=True)
        sys.exit(_DIFFERENT)


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


def _refuse_two_choices(*, index: int | None, best: bool, outcome: int | None) -> None:
    choices = {"--index": index is not None, "--best": best, "--outcome": outcome is not None}
    given = [name for name, chosen in choices.items() if chosen]
    if len(given) > 1:
        raise LQDError(
            f"Expected one of --index, --best and --outcome, got {' and '.join(given)}; leave "
            f"{'one' if len(given) == 2 else 'two'} out."
        )


def _chosen(run: RunFolder, *, index: int | None, outcome: int | None) -> StoredMotion:
    if outcome is not None:
        return StoredMotion.outcome(run.outcomes(), outcome)
    archive = run.archive()
    return StoredMotion.elite(archive, best_success(archive) if index is None else index)
