"""A cell that is being run, in a process of its own."""

import csv
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from types import MappingProxyType

from benchmarks.tables.cell import Cell
from lqd_search.runs.run_folder import METRICS

CellCommand = Callable[[Cell, Path], Sequence[str]]
"""Returns the command that begins a cell's run in a folder, or goes on with the one there."""

# One cell a CPU is what keeps them all busy: libraries that start more threads only get in the way.
_ONE_THREAD = MappingProxyType(
    {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
)
# The last line of what it printed says why it failed, and held-back output would come after it.
_LINES_IN_ORDER = MappingProxyType({"PYTHONUNBUFFERED": "1"})


def run_command(*, evaluations: int, batch_size: int) -> CellCommand:
    """Return how a cell is run by `lqd run`."""

    def command(cell: Cell, folder: Path) -> Sequence[str]:
        head = (sys.executable, "-m", "lqd_search", "run", "--threads", "1")
        if folder.exists():
            return (*head, "--resume", str(folder))
        return (
            *(*head, cell.task_id, "--method", cell.method, "--out", str(folder)),
            *("--seed", str(cell.seed), "--sample", str(cell.sample)),
            *("--evaluations", str(evaluations), "--batch-size", str(batch_size)),
        )

    return command


def spent(folder: Path) -> int:
    """Return how many evaluations a run has spent, as far as it has written them down."""
    try:
        with (folder / METRICS).open(newline="") as file:
            return int(list(csv.DictReader(file))[-1]["evaluations"])
    except (OSError, IndexError, KeyError, TypeError, ValueError):
        # There is none yet, or a row is just being written.
        return 0


class CellProcess:
    """A cell that is being run.

    Args:
        cell: The cell.
        command: What to run.
        folder: The folder of its run.
        log: Where to write what it prints.
        lock: An open file that the process inherits.
    """

    def __init__(
        self, cell: Cell, *, command: Sequence[str], folder: Path, log: Path, lock: int
    ) -> None:
        self.cell = cell
        self._folder = folder
        self._log = log
        with log.open("wb") as output:
            # In a session of its own Ctrl-C does not reach it: who started it ends it.
            self._process = subprocess.Popen(
                list(command),
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
                env={**os.environ, **_ONE_THREAD, **_LINES_IN_ORDER},
                pass_fds=(lock,),
                start_new_session=True,
            )

    @property
    def running(self) -> bool:
        """Whether it has not ended yet."""
        return self._process.poll() is None

    @property
    def failure(self) -> str | None:
        """Why it ended without a result, in its own words; None: it did not."""
        status = self._process.poll()
        if not status:
            return None
        lines = self._log.read_text(errors="replace").split("\n")
        last = next((line for line in reversed(lines) if line.strip()), "nothing")
        if status > 0:
            return f"exit status {status}: {last.strip()}"
        # It had no time to say why; too little memory is the usual reason.
        ended = signal.strsignal(-status) or "a signal"
        return f"ended from outside ({ended}), after it had printed: {last.strip()}"

    @property
    def evaluations(self) -> int:
        """Evaluations that it has spent so far, as far as it has written down."""
        return spent(self._folder)

    def stop(self) -> None:
        """End it where it is; it can be gone on with."""
        if self.running:
            self._process.kill()
        self._process.wait()
