import errno
import os
import random
import signal
import subprocess
import sys
import time

import pytest

from lqd_envs import atomic_file
from lqd_envs.atomic_file import write_atomically

REWRITE_FOR_EVER = """
import itertools, runpy, sys
from pathlib import Path

# The module alone, since importing its package takes a second.
write_atomically = runpy.run_path(sys.argv[2])["write_atomically"]
for i in itertools.count():
    content = b"%d" % (i % 10) * (200_000 if i % 2 else 3_000_000)
    write_atomically(Path(sys.argv[1]), [b"%8d" % len(content), content])
    print(i, flush=True)
"""

DIE_BEFORE_A_LINE = """
import os, signal, sys
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

# The module alone, since importing its package takes a second.
spec = spec_from_file_location("atomic_file", sys.argv[3])
atomic_file = module_from_spec(spec)
spec.loader.exec_module(atomic_file)
left = int(sys.argv[2])

def trace(frame, event, _):
    global left
    if frame.f_code.co_filename != atomic_file.__file__:
        return None
    if event == "line":
        left -= 1
        if left == 0:
            os.kill(os.getpid(), signal.SIGKILL)
    return trace

sys.settrace(trace)
atomic_file.write_atomically(Path(sys.argv[1]), [b"new", b" content"])
"""


def test_it_writes_what_it_is_given_and_leaves_nothing_else(tmp_path):
    path = tmp_path / "file"
    for content, expected in (
        (b"old", b"old"),
        (b"", b""),
        ([b"in ", bytearray(b"pieces"), memoryview(b"!")], b"in pieces!"),
        (memoryview(b"view"), b"view"),
        ([], b""),
    ):
        write_atomically(path, content)
        assert path.read_bytes() == expected
    assert list(tmp_path.iterdir()) == [path]


def test_a_part_that_a_killed_run_left_is_no_obstacle(tmp_path):
    (tmp_path / ".file.part").write_bytes(b"left over, and longer than what comes")
    write_atomically(tmp_path / "file", b"new")
    assert [p.read_bytes() for p in tmp_path.iterdir()] == [b"new"]


def fail_to_sync(_):
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def test_after_a_failure_the_old_file_is_untouched_and_no_part_is_left(tmp_path, monkeypatch):
    path = tmp_path / "file"
    write_atomically(path, b"old")
    monkeypatch.setattr(atomic_file.os, "fsync", fail_to_sync)
    with pytest.raises(OSError, match="No space left"):
        write_atomically(path, b"new")
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]


def test_a_folder_that_is_not_there_is_an_os_error(tmp_path):
    with pytest.raises(FileNotFoundError):
        write_atomically(tmp_path / "nowhere" / "file", b"new")


@pytest.mark.parametrize("number", [errno.EINVAL, errno.ENOTSUP])
def test_a_file_system_that_cannot_sync_folders_is_no_failure(tmp_path, monkeypatch, number):
    synced = []

    def fsync(descriptor):
        synced.append(os.path.isdir(f"/proc/self/fd/{descriptor}"))  # noqa: PTH112
        if synced[-1]:
            raise OSError(number, os.strerror(number))

    monkeypatch.setattr(atomic_file.os, "fsync", fsync)
    write_atomically(tmp_path / "file", b"new")
    assert synced == [False, True]
    assert (tmp_path / "file").read_bytes() == b"new"


def test_another_failure_to_sync_the_folder_is_told(tmp_path, monkeypatch):
    calls = []

    def fsync(_):
        calls.append(None)
        if len(calls) == 2:
            raise OSError(errno.EIO, os.strerror(errno.EIO))

    monkeypatch.setattr(atomic_file.os, "fsync", fsync)
    with pytest.raises(OSError, match="Input/output error"):
        write_atomically(tmp_path / "file", b"new")


def test_killed_at_random_moments_it_leaves_a_complete_file(tmp_path):
    path, moments = tmp_path / "file", random.Random(0)
    for _ in range(5):
        with subprocess.Popen(
            [sys.executable, "-c", REWRITE_FOR_EVER, str(path), atomic_file.__file__],
            stdout=subprocess.PIPE,
        ) as child:
            child.stdout.readline()
            time.sleep(moments.uniform(0.0, 0.05))
            child.kill()
        assert child.returncode == -signal.SIGKILL
        length, content = path.read_bytes()[:8], path.read_bytes()[8:]
        assert len(content) == int(length) > 0
        assert len(set(content)) == 1


def test_killed_before_any_of_its_lines_it_leaves_the_old_or_the_new_file(tmp_path):
    path, found, status = tmp_path / "file", [], -signal.SIGKILL
    while status == -signal.SIGKILL:
        path.write_bytes(b"old")
        status = subprocess.run(
            [
                *(sys.executable, "-c", DIE_BEFORE_A_LINE),
                *(str(path), str(len(found) + 1), atomic_file.__file__),
            ],
            check=False,
        ).returncode
        found.append(path.read_bytes())
    assert status == 0
    change = found.index(b"new content")
    assert change > 5
    assert found == [b"old"] * change + [b"new content"] * (len(found) - change)
