"""Headless Chromium, steered over a pipe, and small runs to report."""

import base64
import json
import os
import shutil
import subprocess
import sys
from contextlib import closing, contextmanager
from dataclasses import replace
from select import select
from types import UnionType
from typing import get_args, get_origin, get_type_hints

import numpy as np
import pytest

from lqd_envs import get_task, rollout
from lqd_envs.tasks.examples import example_solutions
from lqd_search.archives.grid_spec import GridSpec
from lqd_search.report import ReportedRun
from lqd_search.runs.function_text import FunctionText
from lqd_search.runs.run_config import RunConfig
from lqd_search.runs.stored_archive import StoredArchive, StoredGrid
from lqd_search.runs.summary import Summary

TASK = get_task("LQD/Faucet-v0")
DIMS = {"start.row": (12,), "start.place": (6, 5), "end.place": (4, 3, 2), "end.pose": (3,) * 5}

_NAMES = ("chromium", "chromium-browser", "google-chrome")
_OPTIONS = (
    *("--headless=new", "--remote-debugging-pipe", "--no-first-run", "--disable-extensions"),
    *("--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-background-networking"),
    *("--window-size=1300,1000", "--hide-scrollbars", "--force-device-scale-factor=1"),
    # A container's root has no sandbox, and may have little shared memory.
    *("--no-sandbox", "--disable-dev-shm-usage"),
)
_PATIENCE = 120.0
# Chromium reads its pipe from descriptor 3 and answers on 4.
_LAUNCH = """
import fcntl, os, sys
ends = [fcntl.fcntl(int(end), fcntl.F_DUPFD, 10) for end in sys.argv[1:3]]
os.dup2(ends[0], 3)
os.dup2(ends[1], 4)
os.execv(sys.argv[3], sys.argv[3:])
"""


class Browser:
    """The DevTools protocol of a running browser: messages that end with a zero byte."""

    def __init__(self, commands, answers, log):
        self._commands, self._answers, self._log = commands, answers, log
        self._number = 0
        self._rest = b""

    def send(self, method, *, session=None, note=lambda _: None, **arguments):
        """Carry out a command; events of the session that come before its answer are noted."""
        self._number += 1
        message = {"id": self._number, "method": method, "params": arguments}
        message |= {"sessionId": session} if session else {}
        self._commands.write(json.dumps(message).encode() + b"\0")
        self._commands.flush()
        while (answer := self.read()).get("id") != self._number:
            if answer.get("sessionId") == session:
                note(answer)
        assert "error" not in answer, answer
        return answer["result"]

    def read(self):
        while b"\0" not in self._rest:
            # Without it a promise that is never kept would hang the test.
            assert select([self._answers], [], [], _PATIENCE)[0], "the browser does not answer"
            block = os.read(self._answers, 1 << 20)
            assert block, f"the browser has ended: {self._log.read_text()}"
            self._rest += block
        message, _, self._rest = self._rest.partition(b"\0")
        return json.loads(message)


class Page:
    """One page in a browser, with all that it complained of and asked for."""

    def __init__(self, browser, path):
        self._browser = browser
        self.complaints, self.requests = [], []
        self._target = browser.send("Target.createTarget", url="about:blank")["targetId"]
        attached = browser.send("Target.attachToTarget", targetId=self._target, flatten=True)
        self._session = attached["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self._send(f"{domain}.enable")
        self._send("Page.navigate", url=path.absolute().as_uri())
        while (event := browser.read()).get("method") != "Page.loadEventFired":
            self._note(event)
        self.run("""new Promise((resolve) => {
            const root = document.documentElement;
            const look = () => root.dataset.done ? resolve() : setTimeout(look, 20);
            look();
        })""")

    def run(self, script):
        """Return what a script comes to; a promise is waited for."""
        result = self._send(
            "Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True
        )
        assert "exceptionDetails" not in result, result
        return result["result"].get("value")

    def picture(self, path):
        result = self._send("Page.captureScreenshot", captureBeyondViewport=True)
        path.write_bytes(base64.b64decode(result["data"]))

    def point(self, x, y):
        """Move the mouse to a place of the window."""
        self._send("Input.dispatchMouseEvent", type="mouseMoved", x=x, y=y)

    def close(self):
        self._browser.send("Target.closeTarget", targetId=self._target)

    def _send(self, method, **arguments):
        return self._browser.send(method, session=self._session, note=self._note, **arguments)

    def _note(self, event):
        method, what = event.get("method"), event.get("params", {})
        if method == "Runtime.exceptionThrown":
            self.complaints.append(what["exceptionDetails"])
        elif method == "Log.entryAdded" and what["entry"]["level"] in ("error", "warning"):
            self.complaints.append(what["entry"])
        elif method == "Runtime.consoleAPICalled" and what["type"] in ("error", "warning"):
            self.complaints.append(what["args"])
        elif method == "Network.requestWillBeSent":
            self.requests.append(what["request"]["url"])


@contextmanager
def started_browser(folder):
    """Start a browser with a profile of its own in a folder."""
    program = next(filter(None, map(shutil.which, _NAMES)), None)
    if program is None:
        pytest.skip(f"no browser to look at a report with: none of {', '.join(_NAMES)} is here")
    read_commands, commands = os.pipe()
    answers, write_answers = os.pipe()
    ends = (read_commands, write_answers)
    log = folder / "browser.log"
    command = [program, *_OPTIONS, f"--user-data-dir={folder / 'profile'}"]
    with log.open("wb") as errors:
        process = subprocess.Popen(
            [sys.executable, "-c", _LAUNCH, *map(str, ends), *command],
            pass_fds=ends,
            stdout=subprocess.DEVNULL,
            stderr=errors,
        )
    for end in ends:
        os.close(end)
    try:
        with os.fdopen(commands, "wb") as file:
            yield Browser(file, answers, log)
    finally:
        process.kill()
        process.wait()
        os.close(answers)


@pytest.fixture(scope="session")
def browser(tmp_path_factory):
    with started_browser(tmp_path_factory.mktemp("browser")) as browser:
        yield browser


@pytest.fixture(scope="session")
def look_at(browser):
    """Open a report in a page of the browser; close it after the `with` block."""
    return lambda path: closing(Page(browser, path))


@pytest.fixture(scope="session")
def archive():
    """The example motions of a task that touch its object, as if a search had found them."""
    solutions = example_solutions(TASK)[-24:]
    trajectories = rollout(TASK, solutions)
    n = len(solutions)
    fields = {
        "solution": solutions,
        "objective": np.linspace(0.0, 1.0, n),
        "success": trajectories.columns.joint_positions[:, -1, 0] > 0.5,
        "evaluation": np.arange(n) * 10,
        "expert": trajectories.success(),
        "ground_truth": trajectories.ground_truth(),
        "digest": trajectories.digests(),
    }
    return StoredArchive(fields, {name: _grid(dims, n) for name, dims in DIMS.items()})


def _grid(dims, elites):
    spec = GridSpec(dims=dims, ranges=((-1.0, 1.0),) * len(dims))
    cells = np.arange(min(spec.cells, elites))
    return StoredGrid(spec, cells, cells[::-1].copy(), np.zeros((len(cells), len(dims))))


@pytest.fixture(scope="session")
def new_run(archive, make_metrics):
    """Make a run that has one text in all the places that take any."""
    stages = ("first batch", "exploring near", "continuing with near")
    metrics = tuple(make_metrics(i, stage=stage) for i, stage in enumerate(stages, 1))

    def make(label="run", *, text="plain", archive=archive, **changes):
        code = f"def fitness(info):\n    # {text}\n    return {text!r}\n"
        named = {"task": TASK.id, "method": "ours"}
        run = ReportedRun(
            label=label,
            task=TASK,
            config=replace(filled(RunConfig, text), **named),
            summary=filled(Summary, text) | named | {"chosen_fitness": "flat"},
            metrics=metrics,
            archive=archive,
            functionals=(
                FunctionText("success", "success", text, code),
                FunctionText("fitness", text, text, code),
            ),
        )
        return replace(run, **changes)

    return make


def filled(hint, text):
    """Return what has the form of a type hint, with this text as every text in it."""
    kind = get_origin(hint) or hint
    if hint in (str, int, float):
        return {str: text, int: 3, float: 1.5}[hint]
    if kind is UnionType:
        return filled(get_args(hint)[0], text)
    if kind in (list, tuple):
        return kind([filled(get_args(hint)[0], text)])
    if kind is dict:
        return {text: filled(get_args(hint)[1], text), "flat": filled(get_args(hint)[1], text)}
    return kind(**{name: filled(one, text) for name, one in get_type_hints(kind).items()})
