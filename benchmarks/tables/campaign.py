"""Running the cells of a benchmark, several at a time, and keeping what is finished."""

import time
from collections.abc import Callable, Iterable
from contextlib import ExitStack
from dataclasses import dataclass, field

from benchmarks.tables.cell import Cell
from benchmarks.tables.cell_figures import CellError, CellFigures
from benchmarks.tables.cell_process import CellCommand, CellProcess
from benchmarks.tables.cell_store import CellStore
from benchmarks.tables.machine import describe_commit, describe_machine
from benchmarks.tables.run_figures import read_run
from lqd_envs import LQDError
from lqd_search.methods.steering import MESH, STEERING
from lqd_search.runs.run_folder import RunFolder

_LOOK_EVERY = 0.25

OnWork = Callable[[int], None]
"""Is told from time to time how many evaluations the cells that are being run have spent."""
OnCell = Callable[[CellFigures], None]
"""Is told of each cell that is finished."""


@dataclass(frozen=True)
class Outcome:
    """What became of the cells that were to be run.

    Attributes:
        failed: Why cells ended without a result.
        elsewhere: Cells that another process is running.
    """

    failed: dict[Cell, str] = field(default_factory=dict)
    elsewhere: list[Cell] = field(default_factory=list)


class Campaign:
    """Runs the cells of a benchmark, several at a time.

    A finished cell is kept and not run again. One that was stopped goes on. One that fails does
    not keep the others from being run.

    Args:
        store: Where the cells are kept.
        command: How to run a cell.
        jobs: How many at a time.
    """

    def __init__(self, store: CellStore, *, command: CellCommand, jobs: int) -> None:
        self._store = store
        self._command = command
        self._jobs = jobs
        self._machine = describe_machine()

    def run(self, cells: Iterable[Cell], *, on_work: OnWork, on_cell: OnCell) -> Outcome:
        """Run cells until all are finished; however it ends, no process is left behind.

        Args:
            cells: In the order in which to begin them.
            on_work: Told how far they are.
            on_cell: Told of each finished one.
        """
        self._store.prepare()
        outcome, waiting = Outcome(), list(cells)
        running: list[tuple[CellProcess, ExitStack]] = []
        try:
            while waiting or running:
                while waiting and len(running) < self._jobs:
                    self._begin(waiting.pop(0), running, outcome, on_cell)
                on_work(sum(process.evaluations for process, _ in running))
                ended = [one for one in running if not one[0].running]
                for one in ended:
                    running.remove(one)
                    with one[1]:
                        self._end(one[0], outcome, on_cell)
                if not ended:
                    time.sleep(_LOOK_EVERY)
        finally:
            for process, lock in running:
                with lock:
                    process.stop()
        return outcome

    def _begin(
        self,
        cell: Cell,
        running: list[tuple[CellProcess, ExitStack]],
        outcome: Outcome,
        on_cell: OnCell,
    ) -> None:
        with ExitStack() as stack:
            lock = stack.enter_context(self._store.claim(cell))
            if lock is None:
                outcome.elsewhere.append(cell)
                return
            folder = self._store.run_folder(cell)
            try:
                if folder.exists() and self._checked(cell).finished:
                    # It was killed between the end of the run and the keeping of its figures.
                    self._keep(cell, on_cell)
                    return
            except LQDError as error:
                outcome.failed[cell] = str(error)
                return
            if not folder.exists():
                self._store.forget_commits(cell)
            self._store.note_commit(cell, describe_commit())
            process = CellProcess(
                cell,
                command=self._command(cell, folder),
                folder=folder,
                log=self._store.log(cell),
                lock=lock,
            )
            running.append((process, stack.pop_all()))

    def _checked(self, cell: Cell) -> RunFolder:
        run = RunFolder.open(self._store.run_folder(cell))
        config, store = run.config(), self._store
        if (config.evaluations, config.batch_size) != (store.evaluations, store.batch_size):
            raise CellError(
                f"Expected a run of {store.evaluations} evaluations, {store.batch_size} a "
                f"generation, in {run.path}, but it has {config.evaluations} and "
                f"{config.batch_size}; give each scale a folder of its own with --out."
            )
        return run

    def _end(self, process: CellProcess, outcome: Outcome, on_cell: OnCell) -> None:
        try:
            if process.failure is not None:
                raise CellError(process.failure)
            self._keep(process.cell, on_cell)
        except LQDError as error:
            outcome.failed[process.cell] = str(error)

    def _keep(self, cell: Cell, on_cell: OnCell) -> None:
        # Each process takes the sources that are there when it begins: where they were changed on
        # the way, all commits are named.
        commits = [*self._store.commits(cell), describe_commit()]
        figures = read_run(
            self._store.run_folder(cell),
            cell=cell,
            # All that is no method is a variant of `ours`.
            steering=STEERING.get(cell.method, MESH),
            machine=self._machine,
            commit=", ".join(dict.fromkeys(filter(None, commits))),
        )
        self._store.keep(figures)
        on_cell(figures)
