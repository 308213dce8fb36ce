import numpy as np
import pytest
from imageio_ffmpeg import count_frames_and_secs

from lqd_envs import LQDError
from lqd_search.cli.video import check_video_path, write_video

FRAMES = tuple(np.full((48, 64, 3), 3 * i, np.uint8) for i in range(10))


def test_a_video_has_every_frame(tmp_path):
    write_video(tmp_path / "film.mp4", FRAMES)

    assert count_frames_and_secs(tmp_path / "film.mp4")[0] == 10
    assert [file.name for file in tmp_path.iterdir()] == ["film.mp4"]


def test_where_ffmpeg_cannot_write_it_is_one_sentence_and_nothing_is_left(tmp_path, capfd):
    # A folder where the file would be: ffmpeg cannot open it for writing.
    (tmp_path / ".film.part.mp4").mkdir()

    with pytest.raises(
        LQDError,
        match=r"^Expected to write the video \S+, but that failed [^\n]+ --video\.$",
    ):
        write_video(tmp_path / "film.mp4", FRAMES)

    assert not (tmp_path / "film.mp4").exists()
    assert capfd.readouterr().err == ""


def test_what_ffmpeg_left_unfinished_is_removed(tmp_path, monkeypatch):
    def write_half(path, *_, **__):
        path.write_bytes(b"half of a video")

    monkeypatch.setattr("imageio.v3.imwrite", write_half)

    with pytest.raises(LQDError, match="ffmpeg left a file that cannot be read"):
        write_video(tmp_path / "film.mp4", FRAMES)

    assert list(tmp_path.iterdir()) == []


def test_frames_that_are_missing_are_noticed(tmp_path, monkeypatch):
    monkeypatch.setattr("imageio_ffmpeg.count_frames_and_secs", lambda _: (9, 0.18))

    with pytest.raises(LQDError, match="ffmpeg wrote 9 of 10 frames"):
        write_video(tmp_path / "film.mp4", FRAMES)

    assert list(tmp_path.iterdir()) == []


def test_a_link_to_nothing_is_not_written_through(tmp_path):
    (tmp_path / "film.mp4").symlink_to(tmp_path / "nothing.mp4")

    with pytest.raises(LQDError, match=r"film\.mp4 exists already"):
        check_video_path(tmp_path / "film.mp4")


@pytest.mark.parametrize("name", [f"{'a' * 300}.mp4", f"{'a' * 300}/film.mp4"])
def test_a_name_that_is_too_long_is_one_sentence(tmp_path, name):
    with pytest.raises(
        LQDError, match=r"mp4 cannot be used \(File name too long\); choose another"
    ):
        check_video_path(tmp_path / name)
