"""The check of functions before they are used: on example motions, in the sandbox."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from numpy.typing import NDArray

from lqd_llm.check import Candidate, CheckFailure, CheckOutcome
from lqd_llm.check_results import MOMENTS, CheckResults
from lqd_llm.errors import InferenceError
from lqd_llm.recorded_code import is_recorded
from lqd_llm.sandbox import (
    CheckedSource,
    InfoLayout,
    Limits,
    RejectedCodeError,
    Role,
    Sandbox,
    SandboxedFunction,
    check_source,
)


class FunctionCheck:
    """Checks functions: first their code alone, then what they do on example motions.

    A function fails when the sandbox does not allow its code; when its value is refused on any of
    the motions; when a quantity or a descriptor gives more numbers at one time than at another;
    when a descriptor is defined on none of the motions; when it gives another value the second
    time; and when it is too slow, takes too much memory or crashes. A quantity is called at the
    first, the middle and the last moment of each motion, and wherever the timestamps of the same
    call look. What one function does is never held against another.

    No verdict of an expert is known here, so none can enter what is said of a function.

    Args:
        layout: The keys of an info.
        columns: For each key, the column of N example motions, at least one.
        limits: What a function may use.
        allow_weak: Whether code that nobody recorded may run without the locks that this system
            does not have. Code that ships with the package may in any case: anybody can read it.

    Attributes:
        motions: N, the number of example motions.

    Raises:
        InferenceError: There is no example motion.
    """

    def __init__(
        self,
        layout: InfoLayout,
        columns: Mapping[str, NDArray[Any]],
        *,
        limits: Limits | None = None,
        allow_weak: bool = False,
    ) -> None:
        self.motions = min((len(column) for column in columns.values()), default=0)
        if not self.motions:
            raise InferenceError(
                "Expected at least one example motion to check functions on, but got none; pass "
                "valid motions of the task."
            )
        self._layout = layout
        self._columns = columns
        # A function that keeps something from one motion to the next gives itself away.
        self._backwards = {key: column[::-1] for key, column in columns.items()}
        self._limits = limits
        self._allow_weak = allow_weak

    def check(self, candidates: Sequence[Candidate]) -> list[CheckOutcome]:
        """Check functions, all of them in one sandbox; it implements `CheckFunction`.

        Args:
            candidates: The functions.

        Raises:
            SandboxError: The sandbox does not start, or lacks a layer that this code needs.
        """
        outcomes: dict[int, CheckOutcome] = {}
        sources: dict[int, CheckedSource] = {}
        for number, candidate in enumerate(candidates):
            try:
                sources[number] = check_source(candidate.source.code, entry=candidate.entry)
            except RejectedCodeError as error:
                outcomes[number] = CheckOutcome(_rejection(error))
        functions = {
            number: SandboxedFunction(str(number), Role(candidates[number].entry), source)
            for number, source in sources.items()
        }
        if functions:
            recorded = all(is_recorded(candidates[number].source.code) for number in functions)
            results = self._run(functions.values(), allow_weak=self._allow_weak or recorded)
            outcomes |= {number: results.outcome(its) for number, its in functions.items()}
        return [outcomes[number] for number in range(len(candidates))]

    def require_sandbox(self) -> None:
        """Start a sandbox for code that nobody recorded, and end it.

        Whoever is about to pay for such code learns here that it could not run.

        Raises:
            SandboxError: It does not start, or lacks a layer.
        """
        with self._sandbox(MOMENTS, allow_weak=self._allow_weak):
            return

    def _run(self, functions: Iterable[SandboxedFunction], *, allow_weak: bool) -> CheckResults:
        with self._sandbox([*MOMENTS, *functions], allow_weak=allow_weak) as sandbox:
            first = sandbox.run(self._columns)
            second = sandbox.run(self._backwards)
            return CheckResults(first, second, dropped=sandbox.dropped, motions=self.motions)

    def _sandbox(self, functions: Sequence[SandboxedFunction], *, allow_weak: bool) -> Sandbox:
        return Sandbox(
            self._layout, functions=functions, limits=self._limits, allow_weak=allow_weak
        )


def _rejection(error: RejectedCodeError) -> CheckFailure:
    return CheckFailure(type(error).__name__, error.reason, error.line)
