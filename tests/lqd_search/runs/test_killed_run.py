"""A run that is killed again and again ends bit for bit like one that never was."""

import csv
import json
import os
import subprocess
import sys
from bisect import bisect_left
from pathlib import Path

import numpy as np
import pytest

from lqd_search.runs.run_folder import RunFolder

SIZE = ["--evaluations", "640", "--batch-size", "32", "--threads", "1"]


class KillServer:
    """The process that runs `lqd` in its forks; `kill_server.py` says how."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.log = folder.parent / "log"
        self.process = subprocess.Popen(
            [sys.executable, Path(__file__).with_name("kill_server.py"), self.log, folder],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env={**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"},
        )

    def __call__(self, *arguments, **request):
        request["arguments"] = [str(argument) for argument in arguments]
        print(json.dumps(request), file=self.process.stdin, flush=True)
        return json.loads(self.process.stdout.readline())

    def printed(self) -> str:
        return self.log.read_text()


@pytest.fixture(scope="module")
def server(tmp_path_factory):
    folder = tmp_path_factory.mktemp("killed") / "runs"
    folder.mkdir()
    server = KillServer(folder)
    with server.process:
        yield server
        server.process.stdin.close()


class Course:
    """The file operations of a run that nobody stops, by what a run that goes on has to repeat."""

    def __init__(self, operations, name):
        self.length = len(operations)
        self.begun = operations.index(["os.rename", name]) + 1
        segments = [
            i for i, (kind, path) in enumerate(operations)
            if kind == "open" and path.startswith(f"{name}/checkpoint-outcomes/")
        ]  # fmt: skip
        archive = operations.index(["open", f"{name}/.archive.npz.part"])
        # Where each generation is complete: for the first ones, where the next one begins.
        self.complete = [self.begun, *segments[1:], archive]
        # Before the first segment there is its folder to be made.
        self.prelude = segments[0] - 1 - self.begun
        self.finished = operations.index(["os.rename", f"{name}/summary.json"]) + 1

    def number(self, moment: int, folder: RunFolder) -> int:
        """Return which operation of a process that goes on with the run a moment is."""
        if not folder.path.exists():
            return moment
        if folder.finished:
            return moment - self.finished
        state = folder.state.load()
        done = len(state.metrics) if state else 0
        return moment - self.complete[done] + (self.prelude if done else 0)


def kill_again_and_again(server, course, folder, options, *, moments, rng):
    """Kill a run at every one of the moments, at every third some time after the one before."""
    for i, moment in enumerate(moments):
        resume = (
            ["--resume", folder.path] if folder.path.exists() else [*options, "--out", folder.path]
        )
        request = {"operation": course.number(moment, folder)}
        earlier = moments[i - 1] + 1 if i else 0
        if i % 3 == 2 and not folder.finished:
            request["last"] = request["operation"]
            request["operation"] -= (moment - earlier) // 2
            request["seconds"] = rng.uniform(0.0, 0.5)
        assert server("run", *resume, **request) == -9, server.printed()


def assert_equal_but_for_seconds(one: Path, other: Path) -> None:
    files = {str(p.relative_to(one)) for p in one.rglob("*")}
    assert {str(p.relative_to(other)) for p in other.rglob("*")} == files
    for name in files - {"metrics.csv", "summary.json"}:
        if (one / name).is_file():
            assert (one / name).read_bytes() == (other / name).read_bytes(), name
    assert _metrics(one) == _metrics(other)
    assert _summary(one) == _summary(other)


def _metrics(folder):
    with (folder / "metrics.csv").open(newline="") as file:
        return [{**row, "seconds": ""} for row in csv.DictReader(file)]


def _summary(folder):
    return {**json.loads((folder / "summary.json").read_text()), "seconds": 0}


def check(server, task, method, *, kills, seed):
    # With these seeds there are successes to be kept.
    options = [task, *SIZE, "--method", method, "--seed", str(seed)]
    whole = server.folder / method
    status, operations = server("run", *options, "--out", whole, here=True)
    assert status == 0, server.printed()
    course = Course(operations, method)
    rng = np.random.default_rng(0)
    # One in the first generation, one while the checkpoint is being removed, the others anywhere
    # up to the end of the results.
    first = int(rng.integers(course.complete[1]))
    rest = np.arange(first + 1, course.finished)
    moments = [
        first,
        *sorted(rng.choice(rest, kills - 2, replace=False).tolist()),
        int(rng.integers(course.finished, course.length)),
    ]
    folder = RunFolder(server.folder / f"{method}-killed")
    kill_again_and_again(server, course, folder, options, moments=moments, rng=rng)
    assert server("run", "--resume", folder.path) == 0, server.printed()
    assert_equal_but_for_seconds(whole, folder.path)
    assert len(folder.outcomes()["solution"]) > 0
    return course, moments


def test_a_run_killed_at_20_moments_ends_like_one_that_was_never_killed(server):
    course, moments = check(server, "LQD/Drawer-v0", "ours", kills=20, seed=5)
    assert len(set(moments)) == 20
    assert moments[0] < course.complete[1] <= moments[4]
    assert bisect_left(moments, course.complete[-1]) < 19


@pytest.mark.slow
@pytest.mark.parametrize("method", ["direct", "handcrafted", "ga", "random"])
def test_every_method_survives_being_killed(server, method):
    check(server, "LQD/Faucet-v0", method, kills=6, seed=4)
