"""Keeping a worker at work: starting it, replacing it, and finding the function at fault."""

import json
from collections.abc import Sequence
from concurrent.futures import Executor

import numpy as np
from numpy.typing import NDArray

from lqd_llm.sandbox.deaths import DEATHS, VAIN_DEATHS, Deaths
from lqd_llm.sandbox.errors import SandboxError
from lqd_llm.sandbox.functions import SandboxedFunction
from lqd_llm.sandbox.info_layout import InfoLayout
from lqd_llm.sandbox.limits import Limits
from lqd_llm.sandbox.process import Ended, Ending, WorkerProcess
from lqd_llm.sandbox.reasons import Reason, words
from lqd_llm.sandbox.record_check import check_counts, check_definitions, check_header
from lqd_llm.sandbox.results import DroppedFunction
from lqd_llm.sandbox.roles import Role
from lqd_llm.sandbox.shared_memory import SharedMemory
from lqd_llm.sandbox.wire import (
    DEFINITIONS_OFFSET,
    HEADER_BYTES,
    NO_FUNCTION,
    RECORD,
    Command,
    Lock,
    Status,
    Word,
    function_of,
    records_offset,
    slots_of,
)


class Supervisor:
    """Keeps a worker at work.

    Args:
        layout: The keys of an info.
        functions: The functions.
        columns: The shared columns.
        results: The shared results.
        limits: What a function may use.
        allow_weak: Whether locks may be missing.
        starter: Starts workers, in a thread that lasts as long as they.

    Attributes:
        dropped: The functions that were dropped so far, by role and name.
    """

    def __init__(
        self,
        layout: InfoLayout,
        functions: Sequence[SandboxedFunction],
        *,
        columns: SharedMemory,
        results: SharedMemory,
        limits: Limits,
        allow_weak: bool,
        starter: Executor,
    ) -> None:
        self.dropped: dict[tuple[Role, str], DroppedFunction] = {}
        self._layout = layout
        self._functions = functions
        self._columns = columns
        self._results = results
        self._limits = limits
        self._allow_weak = allow_weak
        self._starter = starter
        self._worker: WorkerProcess | None = None
        self._deaths = Deaths()
        self._failures = 0

    @property
    def pid(self) -> int | None:
        """The worker's process, if there is one."""
        return self._worker.pid if self._worker else None

    def are_dropped(self) -> list[bool]:
        """Return for each function whether it was dropped."""
        return [(function.role, function.name) in self.dropped for function in self._functions]

    def start(self) -> None:
        """Start a worker that has defined the functions.

        Raises:
            SandboxError: None starts, a lock is missing, or they die again and again.
        """
        self._deaths = Deaths()
        while not self._try_to_start(motion=-1):
            pass

    def stop(self) -> None:
        """End the worker; the next run starts another."""
        if self._worker is not None:
            self._worker.close()
            self._worker = None

    def run(self, *, motions: int, moments: int, first: int) -> None:
        """Have the worker write the records of the motions in the shared columns.

        Args:
            motions: Number of the motions.
            moments: Moments of each.
            first: Index of the first one in the batch, for reports.

        Raises:
            SandboxError: A worker writes a wrong header, none starts, or they die again and again.
        """
        self._words()[Word.DONE] = 0
        self._deaths = Deaths()
        done = 0
        try:
            while done < motions:
                if all(self.are_dropped()):
                    self._refuse_rest(done, motions)
                    return
                if self._worker is None and not self._try_to_start(motion=first + done):
                    continue
                ended = self._ask(Command.RUN, motions, moments, done)
                done, status = self._progress(start=done, motions=motions)
                if ended.ending is not Ending.ANSWERED:
                    self._bury(ended, status, motion=first + done)
                elif done < motions:
                    raise _broken(f"{motions} motions done", str(done))
        except BaseException:
            # Whoever interrupts this leaves a worker behind that is in the middle of something.
            self.stop()
            raise

    def _refuse_rest(self, start: int, motions: int) -> None:
        """Write what a worker would write when there is no function left to call."""
        roles = [function.role for function in self._functions]
        slots = slots_of(roles)
        records = self._results.array(
            RECORD, size=motions * len(slots), offset=records_offset(len(roles))
        ).reshape(motions, len(slots))
        records[start:] = 0
        for k, slot in enumerate(slots):
            refused = Reason.DROPPED if slot.timestamp is None else Reason.NO_MOMENT
            records["reason"][start:, k] = refused

    def _ask(self, command: Command, *numbers: int, text: bytes = b"") -> Ended:
        if self._worker is None:
            raise _broken("a worker", "none")
        return self._worker.ask(command, *numbers, text=text)

    def _try_to_start(self, *, motion: int) -> bool:
        """Return whether there is a worker now; if not, somebody is a little more at fault."""
        words = self._words()
        done = int(words[Word.DONE])
        words[:] = 0
        words[Word.DONE], words[Word.CALL] = done, NO_FUNCTION
        del words
        self._worker = self._started()
        try:
            ready, told = self._worker.wait_until_ready()
            if ready.ending is not Ending.ANSWERED:
                return self._failed_to_start(told)
            self._failures = 0
            self._check_locks(told)
            text = json.dumps(self._told()).encode()
            ended = self._ask(Command.DEFINE, len(text), text=text)
            _, status = self._progress(start=done, motions=done)
            if ended.ending is Ending.ANSWERED:
                self._drop_undefined()
        except BaseException:
            self.stop()
            raise
        if ended.ending is not Ending.ANSWERED:
            self._bury(ended, status, motion=motion, defining=True)
        return self._worker is not None

    def _started(self) -> WorkerProcess:
        shared = {"columns": self._columns, "results": self._results}
        try:
            start = self._starter.submit(lambda: WorkerProcess(**shared, limits=self._limits))
            return start.result()
        # The latter where there cannot even be a thread to start it.
        except (OSError, RuntimeError) as error:
            raise SandboxError(
                f"Expected the system to start a process for the sandbox, but it does not ({error})"
                "; end other programs, or raise the limits on processes (ulimit -u), open files "
                "(ulimit -n) and memory."
            ) from error

    def _failed_to_start(self, told: str) -> bool:
        self.stop()
        self._failures += 1
        # Where the reason is known it will be so again; one that is killed has only had bad luck.
        if self._failures >= (DEATHS if told else VAIN_DEATHS):
            why = told.splitlines()[-1] if told else "they died without a word"
            raise SandboxError(
                f"Expected the sandbox's worker to start, but {self._failures} in a row did not: "
                f"{why}; see whether Python and NumPy start outside the sandbox."
            )
        return False

    def _told(self) -> dict[str, object]:
        return {
            "layout": self._layout.to_json(),
            "functions": [
                {
                    "role": str(function.role),
                    "source": function.source.source,
                    "entry": function.source.entry,
                    "dropped": dropped,
                }
                for function, dropped in zip(self._functions, self.are_dropped(), strict=True)
            ],
        }

    def _check_locks(self, told: str) -> None:
        there = Lock(int(self._words()[Word.LOCKS]) & int(~Lock(0)))
        missing = [str(lock.name).lower() for lock in Lock if lock not in there]
        if missing and not self._allow_weak:
            why = f" ({told.replace(chr(10), '; ')})" if told else ""
            raise SandboxError(
                "Expected all layers of the sandbox, but this system lacks "
                f"{', '.join(missing)}{why}; run functions that you trust with "
                "--allow-weak-sandbox, or use a system that has them."
            )

    def _drop_undefined(self) -> None:
        slots = slots_of([function.role for function in self._functions])
        check_counts(self._words().copy(), functions=len(self._functions), slots=len(slots))
        records = self._results.array(
            RECORD, size=len(self._functions), offset=DEFINITIONS_OFFSET
        ).copy()
        check_definitions(records, dropped=self.are_dropped())
        for number, record in enumerate(records):
            reason = Reason(int(record["reason"]))
            if reason in (Reason.ACCEPTED, Reason.DROPPED):
                continue
            detail, line = int(record["detail"]), int(record["line"])
            text = words(reason, detail=detail, line=line, length=0)
            while_defined = " while it was defined" if reason is Reason.RAISED else ""
            self._drop(number, cause="definition", reason=text + while_defined, motion=-1)

    def _bury(self, ended: Ended, status: Status, *, motion: int, defining: bool = False) -> None:
        """See whose fault the end of a worker was."""
        self.stop()
        function = function_of(ended.call)
        known = function < len(self._functions)
        limits = self._limits
        where = -1 if defining else motion
        if ended.ending is Ending.TIMEOUT and known:
            reason = f"was stopped: it used more than {limits.cpu_seconds:g} s of CPU time"
            self._drop(function, cause="timeout", reason=reason, motion=where)
        elif known and (ended.ending is Ending.MEMORY or status is Status.OUT_OF_MEMORY):
            reason = f"was stopped: it took more than {limits.memory_bytes >> 20} MiB of memory"
            self._drop(function, cause="memory", reason=reason, motion=where)
        elif self._deaths.count(function, motion) >= DEATHS and known:
            still = ended.ending is Ending.STILL
            what = f"stood still for {limits.idle_seconds:g} s" if still else "died"
            reason = f"was stopped: its process {what} {DEATHS} times in a row while it ran"
            self._drop(function, cause="crash", reason=reason, motion=where)
        self._deaths.give_up_when_vain(motion)

    def _drop(self, number: int, *, cause: str, reason: str, motion: int) -> None:
        function = self._functions[number]
        key = (function.role, function.name)
        self.dropped[key] = DroppedFunction(function.name, function.role, cause, reason, motion)
        self._deaths = Deaths()

    def _progress(self, *, start: int, motions: int) -> tuple[int, Status]:
        words = self._words().copy()
        return check_header(words, start=start, motions=motions)

    def _words(self) -> NDArray[np.uint64]:
        return self._results.array(np.dtype("<u8"), size=HEADER_BYTES // 8, offset=0)


def _broken(expected: str, got: str) -> SandboxError:
    return SandboxError(
        f"Expected the sandbox's worker to report {expected}, but it reported {got}; its results "
        "are not used."
    )
