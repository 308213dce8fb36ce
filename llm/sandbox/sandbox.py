"""The sandbox: what runs functions that nobody vouches for."""

from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from threading import Lock as ThreadLock
from types import TracebackType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lqd_llm.sandbox.batch_columns import check_columns, chunk_size, copy_chunk, moment_bytes
from lqd_llm.sandbox.decode import decode
from lqd_llm.sandbox.errors import SandboxError
from lqd_llm.sandbox.functions import SandboxedFunction, check_functions
from lqd_llm.sandbox.info_layout import InfoLayout
from lqd_llm.sandbox.limits import Limits
from lqd_llm.sandbox.record_check import check_records
from lqd_llm.sandbox.results import DroppedFunction, Results
from lqd_llm.sandbox.roles import Role
from lqd_llm.sandbox.shared_memory import SharedMemory
from lqd_llm.sandbox.supervisor import Supervisor
from lqd_llm.sandbox.wire import CAPACITY, RECORD, records_offset, results_bytes, slots_of

_MOMENTS = 76


class Sandbox:
    """Runs functions in a locked worker process, and gives back numbers that were checked.

        with Sandbox(layout, functions=functions) as sandbox:
            results = sandbox.run(columns)

    A function that uses more time or memory than it may is dropped: on that motion and on all later
    ones its values are refused, and everything else goes on. A worker that somebody else ends is
    replaced, and changes nothing. Use it from one thread at a time; while it waits for the worker,
    other threads run.

    Args:
        layout: The keys of an info.
        functions: The functions; of each role there may be none.
        limits: What a function may use.
        allow_weak: Whether to go on without the locks that this system does not have.

    Raises:
        SandboxError: There is no function, or two of a role have the same name.
    """

    def __init__(
        self,
        layout: InfoLayout,
        *,
        functions: Sequence[SandboxedFunction],
        limits: Limits | None = None,
        allow_weak: bool = False,
    ) -> None:
        check_functions(functions)
        self._layout = layout
        self._functions = tuple(functions)
        self._slots = slots_of([function.role for function in functions])
        self._limits = limits or Limits()
        self._allow_weak = allow_weak
        self._running = ThreadLock()
        self._open: _Opened | None = None

    @property
    def dropped(self) -> tuple[DroppedFunction, ...]:
        """The functions that were dropped since the sandbox was opened, in order."""
        return tuple(self._opened().supervisor.dropped.values())

    @property
    def worker_pid(self) -> int | None:
        """The worker's process, while there is one."""
        return self._open.supervisor.pid if self._open else None

    def __enter__(self) -> "Sandbox":
        """Start the worker.

        Raises:
            SandboxError: It does not start, or a lock is missing and `allow_weak` is False.
        """
        if self._open is not None:
            raise SandboxError("Expected a sandbox that is closed, but it is open already.")
        self._open = _Opened(
            self._layout, self._functions, limits=self._limits, allow_weak=self._allow_weak
        )
        try:
            self._open.supervisor.start()
        except BaseException:
            self.close()
            raise
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """End the worker."""
        self.close()

    def close(self) -> None:
        """End the worker and let go of what it shares; a second time does nothing."""
        opened, self._open = self._open, None
        if opened is not None:
            opened.close()

    def run(
        self,
        columns: Mapping[str, NDArray[Any]],
        *,
        lengths: Mapping[tuple[Role, str], int] | None = None,
    ) -> Results:
        """Call all functions on a batch of motions.

        Args:
            columns: For each key of the layout (N, T, ...) bool or float64, of the same N and T;
                only motions that may be judged.
            lengths: How many numbers a quantity or descriptor must give, by role and name; one that
                is not named may give 2 to 5.

        Raises:
            SandboxError: The columns do not fit the layout, the sandbox is not open, or its worker
                does not start, dies again and again, or writes what no worker of ours writes.
        """
        motions, moments = check_columns(columns, self._layout)
        with self._running:
            opened = self._opened()
            before = len(opened.supervisor.dropped)
            records = np.zeros((motions, len(self._slots)), RECORD)
            size = chunk_size(self._layout, moments=moments, room=opened.columns.size)
            for start in range(0, motions, size):
                rows = slice(start, min(start + size, motions))
                self._run_chunk(opened, columns, rows, records)
            dropped = dict(opened.supervisor.dropped)
        return decode(
            records,
            functions=self._functions,
            slots=self._slots,
            lengths=lengths or {},
            dropped=list(dropped.values())[before:],
            dropped_before=dropped,
        )

    def _run_chunk(
        self,
        opened: "_Opened",
        columns: Mapping[str, NDArray[Any]],
        rows: slice,
        records: NDArray[np.void],
    ) -> None:
        motions = rows.stop - rows.start
        moments = copy_chunk(columns, self._layout, rows=rows, into=opened.columns)
        opened.supervisor.run(motions=motions, moments=moments, first=rows.start)
        # A copy of our own: what is checked must not change before it is read.
        copied = opened.results.array(
            RECORD, size=motions * len(self._slots), offset=records_offset(len(self._functions))
        ).copy()
        chunk = copied.reshape(motions, len(self._slots))
        roles = [self._functions[slot.function].role for slot in self._slots]
        are_dropped = opened.supervisor.are_dropped()
        dropped = [are_dropped[slot.function] for slot in self._slots]
        try:
            check_records(chunk, roles=roles, dropped=dropped, moments=moments)
        except SandboxError:
            opened.supervisor.stop()
            raise
        records[rows] = chunk

    def _opened(self) -> "_Opened":
        if self._open is None:
            raise SandboxError(
                "Expected a sandbox that is open, but it is closed; use it in a with statement."
            )
        return self._open


class _Opened:
    """What an open sandbox holds."""

    def __init__(
        self,
        layout: InfoLayout,
        functions: Sequence[SandboxedFunction],
        *,
        limits: Limits,
        allow_weak: bool,
    ) -> None:
        slots = slots_of([function.role for function in functions])
        room = max(CAPACITY * _MOMENTS * moment_bytes(layout), 1)
        size = results_bytes(len(functions), len(slots))
        with ExitStack() as memory:
            self.columns = SharedMemory("lqd-columns", size=room, writable=False)
            memory.callback(self.columns.close)
            self.results = SharedMemory("lqd-results", size=size, writable=True)
            memory.callback(self.results.close)
            self._memory = memory.pop_all()
        # A worker ends with the thread that started it, and runs may come from any thread.
        self._starter = ThreadPoolExecutor(1, thread_name_prefix="lqd-sandbox")
        self.supervisor = Supervisor(
            layout,
            functions,
            columns=self.columns,
            results=self.results,
            limits=limits,
            allow_weak=allow_weak,
            starter=self._starter,
        )

    def close(self) -> None:
        self.supervisor.stop()
        self._starter.shutdown()
        self._memory.close()
