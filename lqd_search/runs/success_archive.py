"""What a method puts out, judged by the expert: the success archive and its coverage."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lqd_envs import GroundTruth
from lqd_search.evaluation.motion_evaluator import EXPERT, GROUND_TRUTH


@dataclass(frozen=True, eq=False)
class SuccessArchive:
    """The part of a method's output that the expert's condition approves.

    Attributes:
        elites: Distinct solutions that the method puts out.
        inferred: Those of them that the inferred condition approves.
        size: Those of them that the expert's condition approves.
        cells: (k,) int64, ascending: cells of the ground-truth grid that these fill.
        counts: (k,) int64: how many of them are in each of these cells.
        outside: How many of them are outside the grid.
    """

    elites: int
    inferred: int
    size: int
    cells: NDArray[np.int64]
    counts: NDArray[np.int64]
    outside: int

    @classmethod
    def of(
        cls, output: Mapping[str, NDArray[Any]], *, ground_truth: GroundTruth
    ) -> "SuccessArchive":
        """Judge a method's output.

        Args:
            output: A column of m rows for each field, `success` and the passive ones among them.
            ground_truth: The task's grid.
        """
        approved = output[EXPERT]
        cells = ground_truth.cells(output[GROUND_TRUTH][approved])
        filled, counts = np.unique(cells[cells >= 0], return_counts=True)
        return cls(
            elites=len(approved),
            inferred=int(output["success"].sum()),
            size=int(approved.sum()),
            cells=filled,
            counts=counts,
            outside=int((cells < 0).sum()),
        )
