"""Folders that one process at a time writes in."""

import errno
import fcntl
import os

import pytest

from lqd_search.runs.folder_lock import folder_locked


def test_one_at_a_time_holds_a_folder_and_lets_go_of_it(tmp_path):
    folder = tmp_path / "some" / "folder"
    with folder_locked(folder) as first, folder_locked(folder) as second:
        assert (first, second) == (True, False)
    with folder_locked(folder) as again:
        assert again


@pytest.mark.parametrize("code", [errno.ENOLCK, errno.EBADF])
def test_where_there_are_no_locks_nobody_is_kept_out(tmp_path, monkeypatch, code):
    def refuse(*_):
        raise OSError(code, os.strerror(code))

    monkeypatch.setattr(fcntl, "flock", refuse)
    with folder_locked(tmp_path) as alone:
        assert alone


def test_an_error_within_is_no_lock_of_another(tmp_path):
    with pytest.raises(BlockingIOError), folder_locked(tmp_path):
        raise BlockingIOError
    with folder_locked(tmp_path) as alone:
        assert alone


def test_what_is_no_folder_cannot_be_held(tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(OSError, match="File exists"), folder_locked(tmp_path / "file"):
        pass
