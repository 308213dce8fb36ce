"""The video of a replay."""

from contextlib import suppress
from pathlib import Path

import numpy as np

from lqd_envs import LQDError
from lqd_search.runs.new_file import why_no_new_file
from lqd_search.runs.replay import Frame

_FRAMES_PER_SECOND = 50


def check_video_path(video: Path) -> None:
    """Check, before the motion is carried out, that a video may get this name.

    Raises:
        LQDError: It is not that of an .mp4 file, is taken or cannot be used, or is in a folder
            that does not exist.
    """
    if video.suffix != ".mp4":
        raise LQDError(
            f"Expected the name of an .mp4 file for the video, got {video}; choose one such as "
            "film.mp4."
        )
    why = why_no_new_file(video)
    if why is not None:
        raise LQDError(f"Expected a new file for the video, but {video} {why}; choose another.")


def write_video(video: Path, frames: tuple[Frame, ...]) -> None:
    """Write a video as a whole: it is there complete, or not at all.

    Raises:
        LQDError: It cannot be written.
    """
    part = video.with_name(f".{video.stem}.part.mp4")
    try:
        # ffmpeg would not say why it cannot write there.
        part.open("wb").close()
        _encode(part, frames)
        part.replace(video)
    except OSError as error:
        with suppress(OSError):
            part.unlink()
        reason = error.strerror or str(error).partition("\n")[0]
        raise LQDError(
            f"Expected to write the video {video}, but that failed ({reason}); see to its folder "
            "and the disk, or choose another with --video."
        ) from error


def _encode(path: Path, frames: tuple[Frame, ...]) -> None:
    import imageio.v3 as iio
    from imageio_ffmpeg import count_frames_and_secs  # type: ignore[import-untyped]

    # yuv420p and even sizes: what every player and browser can show. Quiet, since ffmpeg's own
    # lines would stand before ours.
    iio.imwrite(
        path, np.stack(frames), fps=_FRAMES_PER_SECOND, codec="libx264", ffmpeg_log_level="quiet"
    )
    # On a full disk ffmpeg stops in silence, and what it leaves cannot be read.
    try:
        written, _ = count_frames_and_secs(path)
    except RuntimeError as error:
        raise OSError("ffmpeg left a file that cannot be read") from error
    if written != len(frames):
        raise OSError(f"ffmpeg wrote {written} of {len(frames)} frames")
