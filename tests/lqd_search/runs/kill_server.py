"""Runs `lqd` in forks of this process, and has them killed at chosen moments.

Starting an interpreter with all that `lqd` imports takes many seconds, a fork takes none. For each
line of JSON that it reads it writes one:

    {"arguments": [...]}                      run in a fork
    {"arguments": [...], "here": true}       run in this process, and return the file operations
    {"arguments": [...], "operation": n}     kill a fork instead of its n-th file operation
    {..., "seconds": s, "last": m}           or s seconds after it, or else instead of the m-th

What `lqd` prints is in the file that the first argument names; the second one names the folder
whose files matter.
"""

import io
import json
import os
import signal
import sys
import threading
from pathlib import Path

from matplotlib.figure import Figure

import lqd_search.cli.run  # noqa: F401  main imports it when it is called, which takes seconds
from lqd_search.cli.main import main

_EVENTS = ("os.rename", "os.mkdir", "os.remove", "os.rmdir")
_WRITING = os.O_WRONLY | os.O_RDWR


class FileOperations:
    """Counts what this process changes on the disk, and ends it in time.

    An operation that it is killed at does not take place, but a write has come halfway.
    """

    def __init__(self, folder):
        self.folder = folder
        self.seen = None
        self.told = self.fatal = -1
        self.pipe = None
        sys.addaudithook(self.audit)
        self._fsync, self._open = os.fsync, io.open
        os.fsync, io.open = self.fsync, self.open

    def audit(self, event, arguments):
        if event in _EVENTS:
            self.step(event, arguments[1 if event == "os.rename" else 0])
        elif event == "open" and arguments[2] & _WRITING:
            self.step("open", arguments[0])

    def fsync(self, descriptor):
        self.step("fsync", self.folder)
        self._fsync(descriptor)

    def open(self, file, mode="r", *arguments, **options):
        opened = self._open(file, mode, *arguments, **options)
        if "r" not in mode and self.matters(file):
            write = opened.write

            def write_halfway(content):
                written = write(content[: len(content) // 2])
                opened.flush()
                self.step("write", file)
                return written + write(content[len(content) // 2 :])

            opened.write = write_halfway
        return opened

    def matters(self, path):
        return isinstance(path, str | os.PathLike) and str(path).startswith(self.folder)

    def step(self, kind, path):
        # What is removed goes by its name alone.
        if self.seen is None or not (kind in ("os.remove", "os.rmdir") or self.matters(path)):
            return
        number = len(self.seen)
        if number == self.told:
            os.write(self.pipe, b".")
        if number == self.fatal:
            os.kill(os.getpid(), signal.SIGKILL)
        self.seen.append((kind, os.path.relpath(path, self.folder)))


def run(arguments):
    try:
        main(arguments)
    except SystemExit as stop:
        return int(stop.code or 0)
    return 0


def run_in_fork(operations, arguments, *, operation=-1, seconds=None, last=-1):
    assert len(list(Path("/proc/self/task").iterdir())) == threading.active_count() == 1
    reader, writer = os.pipe()
    child = os.fork()
    if not child:
        os.close(reader)
        operations.seen, operations.pipe = [], writer
        operations.told, operations.fatal = (
            (-1, operation) if seconds is None else (operation, last)
        )
        os._exit(run(arguments))
    os.close(writer)
    if os.read(reader, 1):
        signal.sigtimedwait([signal.SIGCHLD], seconds)
        os.kill(child, signal.SIGKILL)
    os.close(reader)
    _, status = os.waitpid(child, 0)
    signal.sigtimedwait([signal.SIGCHLD], 0)
    return os.waitstatus_to_exitcode(status)


def serve(log, folder):
    answers = os.fdopen(os.dup(1), "w")
    for standard in (1, 2):
        os.dup2(os.open(log, os.O_WRONLY | os.O_CREAT | os.O_APPEND), standard)
    signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGCHLD])
    # To draw takes longer than all the rest, and what is on the pictures does not matter here.
    Figure.savefig = lambda _, file, **__: file.write(b"a picture")
    operations = FileOperations(folder)
    for line in sys.stdin:
        request = json.loads(line)
        if request.pop("here", False):
            operations.seen = []
            answer = [run(request["arguments"]), operations.seen]
            operations.seen = None
        else:
            answer = run_in_fork(operations, **request)
        print(json.dumps(answer), file=answers, flush=True)


if __name__ == "__main__":
    serve(*sys.argv[1:])
