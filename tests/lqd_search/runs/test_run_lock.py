"""The lock on a run."""

import errno
import fcntl
import os
import re
import subprocess
import sys

import pytest

from lqd_search.runs.run_folder_error import RunFolderError
from lqd_search.runs.run_lock import locked

_HOLD = """
import sys
from pathlib import Path
from lqd_search.runs.run_lock import locked
with locked(Path(sys.argv[1])):
    print("held", flush=True)
    sys.stdin.read()
"""


@pytest.fixture
def config(tmp_path):
    path = tmp_path / "config.json"
    path.write_text("{}")
    return path


def test_the_lock_of_a_killed_process_is_free_again(config):
    holder = subprocess.Popen(
        [sys.executable, "-c", _HOLD, config], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    )
    with holder:
        assert holder.stdout.readline() == b"held\n"
        message = "but another process does; wait until it ends"
        with pytest.raises(RunFolderError, match=message), locked(config):
            pass
        holder.kill()

    with locked(config):
        pass
    assert config.read_text() == "{}"


def test_it_ends_where_the_work_fails(config):
    def fail():
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError), locked(config):
        fail()
    with locked(config):
        pass


def test_a_folder_that_is_gone(tmp_path):
    folder = re.escape(str(tmp_path / "not here"))
    message = f"Expected to write .*No such file.* go on with `lqd run --resume '{folder}'`"

    with (
        pytest.raises(RunFolderError, match=message),
        locked(tmp_path / "not here" / "config.json"),
    ):
        pass


def refusing(code):
    def refuse(*_):
        raise OSError(code, os.strerror(code))

    return refuse


def test_a_file_system_that_knows_no_locks(config, monkeypatch):
    monkeypatch.setattr(fcntl, "flock", refusing(errno.ENOLCK))
    held = []
    with locked(config):
        held.append(True)
    assert held


def test_a_lock_that_fails(config, monkeypatch):
    monkeypatch.setattr(fcntl, "flock", refusing(errno.EIO))
    with pytest.raises(RunFolderError, match=r"Input/output error"), locked(config):
        pass
