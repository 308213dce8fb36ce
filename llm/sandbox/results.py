"""What the functions gave for a batch of motions."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from lqd_llm.sandbox.roles import Role

NO_MOMENT = -1
"""In place of a moment's index: the timestamp returned None."""
REFUSED = -2
"""In place of a moment's index: what the timestamp returned was refused."""


@dataclass(frozen=True, eq=False)
class RefusedValues:
    """A function whose values were refused for one reason.

    Attributes:
        name: The function's name.
        role: Its role.
        reason: What was wrong, in words that complete "it ...".
        motions: Indices of the motions, ascending, each once.
    """

    name: str
    role: Role
    reason: str
    motions: NDArray[np.intp]


@dataclass(frozen=True)
class DroppedFunction:
    """A function that was stopped, and that is not called any more.

    Attributes:
        name: The function's name.
        role: Its role.
        cause: `"timeout"`, `"memory"`, `"crash"`, or `"definition"` when its code could not be run.
        reason: Why, in words that complete "it ...". Its values are refused for this reason.
        motion: Index in its batch of the motion on which that happened; -1: before the first.
    """

    name: str
    role: Role
    cause: str
    reason: str
    motion: int

    def __str__(self) -> str:
        """Return this as a sentence."""
        where = f": on motion {self.motion} it" if self.motion >= 0 else ": it"
        return f"The {self.role} function {self.name!r} is no longer called{where} {self.reason}."


@dataclass(frozen=True, eq=False)
class Results:
    """What the functions gave for N motions.

    Attributes:
        success: For each success function (N,) bool; False where refused.
        fitness: For each fitness function (N,) float64; NaN where refused.
        moments: For each timestamp (N,) int64, the index of the moment, `NO_MOMENT` or `REFUSED`.
        quantities: For each timestamp and quantity (N, 5) float64: the numbers, then NaN. All NaN
            where there was no moment or the value was refused.
        lengths: For each of these (N,) int64, how many numbers there are; 0 where all are NaN.
        descriptors: For each descriptor (N, 5) float64, as for quantities.
        descriptor_lengths: For each of these (N,) int64.
        refusals: What was refused, in the order in which it was first met.
        dropped: The functions that were dropped during this batch, in order.
    """

    success: Mapping[str, NDArray[np.bool_]]
    fitness: Mapping[str, NDArray[np.float64]]
    moments: Mapping[str, NDArray[np.int64]]
    quantities: Mapping[tuple[str, str], NDArray[np.float64]]
    lengths: Mapping[tuple[str, str], NDArray[np.int64]]
    descriptors: Mapping[str, NDArray[np.float64]]
    descriptor_lengths: Mapping[str, NDArray[np.int64]]
    refusals: tuple[RefusedValues, ...]
    dropped: tuple[DroppedFunction, ...]
