"""Folders that one process at a time writes in."""

import errno
import fcntl
import os
from threading import Thread

import pytest

from lqd_envs.folder_lock import folder_in_turn, folder_locked


def test_one_at_a_time_holds_a_folder_and_lets_go_of_it(tmp_path):
    folder = tmp_path / "some" / "folder"
    with folder_locked(folder) as first, folder_locked(folder) as second:
        assert (first, second) == (True, False)
    with folder_locked(folder) as again:
        assert again


def test_who_holds_it_for_a_moment_keeps_others_out(tmp_path):
    folder = tmp_path / "some" / "folder"
    for _ in range(2):
        with folder_in_turn(folder), folder_locked(folder) as other:
            assert not other


def test_who_comes_later_has_its_turn_after_the_first(tmp_path):
    order = []

    def second():
        with folder_in_turn(tmp_path):
            order.append("second")

    thread = Thread(target=second)
    with folder_in_turn(tmp_path):
        thread.start()
        thread.join(0.05)
        order.append("first")
    thread.join()

    assert order == ["first", "second"]


def test_a_folder_that_cannot_be_opened_keeps_nobody_out(tmp_path, monkeypatch):
    def refuse(*_):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))

    monkeypatch.setattr(os, "open", refuse)
    with folder_in_turn(tmp_path):
        pass
    with pytest.raises(PermissionError), folder_locked(tmp_path):
        pass


def test_a_folder_that_cannot_be_made_is_an_error(tmp_path, monkeypatch):
    def refuse(*_, **__):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))

    monkeypatch.setattr(os, "mkdir", refuse)
    with pytest.raises(PermissionError), folder_in_turn(tmp_path / "new"):
        pass


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
