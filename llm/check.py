"""What a check of functions is given, and what it finds."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from lqd_llm.reply import FunctionSource


@dataclass(frozen=True)
class Candidate:
    """A function that may be used once it has passed its check.

    Attributes:
        source: The function as it was written.
        kind: What was asked for, one of `lqd_llm.KINDS`.
        entry: Name of the function in the code that is called; it says what the function is given
            and must return, as the roles of `lqd_llm.sandbox` do.
    """

    source: FunctionSource
    kind: str
    entry: str


@dataclass(frozen=True)
class CheckFailure:
    """What a check found wrong with a function.

    Exactly this is told to the model, so nothing of an expert's verdict may be in it.

    Attributes:
        error: Name of the error, such as `"KeyError"`.
        reason: What is wrong, in words.
        line: Where in the function's code, counted from 1, if that is known.
    """

    error: str
    reason: str
    line: int | None = None

    def __str__(self) -> str:
        place = f" in line {self.line}" if self.line is not None else ""
        return f"{self.error}{place}: {self.reason.strip().rstrip('.')}"


@dataclass(frozen=True, eq=False)
class CheckOutcome:
    """What came of the check of one function.

    Attributes:
        failure: What is wrong; None: it can be used.
        length: How many numbers a quantity or a direct descriptor gives, if it passes.
        values: What it gave, if it was called: float64 (N, 1) for each of the N example motions, of
            a timestamp the index of the moment or -1; of a descriptor (N, 5), its numbers and then
            NaN; of a quantity (N, 3, 5), at the first, the middle and the last moment.
    """

    failure: CheckFailure | None = None
    length: int | None = None
    values: NDArray[np.float64] | None = None


CheckFunction: TypeAlias = Callable[[Sequence[Candidate]], Sequence[CheckOutcome]]
"""A check of functions: it returns one outcome for each candidate, in their order."""
