"""The outcome archive: a passive record of every distinct success of a run, whatever its method."""

import hashlib
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from lqd_envs import GroundTruth
from lqd_search.evaluation.motion_evaluator import DIGEST, EXPERT, GROUND_TRUTH
from lqd_search.evaluation.values import Values
from lqd_search.runs.stored_outcomes import (
    FITNESS,
    MEASURES,
    OutcomeError,
    Outcomes,
    check_order,
    check_outcomes,
    check_same_form,
    join,
    to_bytes,
)


@dataclass(frozen=True)
class OutcomeFigures:
    """How many distinct successes a run has found.

    Attributes:
        both: Those that the run's own condition and the expert's approve.
        success_only: Those that only the run's own approves.
        expert_only: Those that only the expert's approves.
        cells: Cells of the ground-truth grid that those fill that the expert's approves.
        outside: Those of them that are outside the grid.
    """

    both: int
    success_only: int
    expert_only: int
    cells: int
    outside: int

    @property
    def outcomes(self) -> int:
        """All of them."""
        return self.both + self.success_only + self.expert_only

    @property
    def success(self) -> int:
        """Those that the run's own condition approves."""
        return self.both + self.success_only

    @property
    def expert(self) -> int:
        """Those that the expert's condition approves."""
        return self.both + self.expert_only


class OutcomeArchive:
    """Keeps every distinct solution that the run's own condition or the expert's approves.

    It is told each generation after the method; nothing that searches reads it. Of each outcome it
    keeps a row of columns and 16 bytes by which it is known again: some 100 bytes with what Python
    adds to them.

    Args:
        ground_truth: The task's grid.
    """

    def __init__(self, ground_truth: GroundTruth) -> None:
        self._ground_truth = ground_truth
        self._blocks: list[Outcomes] = []
        self._known: set[bytes] = set()
        self._counts = np.zeros((2, 2), np.int64)
        self._cells: set[int] = set()
        self._outside = 0

    def __len__(self) -> int:
        """Return the number of outcomes."""
        return len(self._known)

    @classmethod
    def from_blocks(
        cls, blocks: Iterable[Outcomes], *, ground_truth: GroundTruth
    ) -> "OutcomeArchive":
        """Return the archive that returned these blocks when it was told the generations.

        Args:
            blocks: What `add` returned, in order; or all outcomes as one.
            ground_truth: The task's grid.

        Raises:
            OutcomeError: The blocks are not those of one run, each once and in order.
        """
        archive = cls(ground_truth)
        for block in blocks:
            digests = _digests(block["solution"])
            if len(set(digests)) < len(digests) or not archive._known.isdisjoint(digests):
                raise OutcomeError(
                    "Expected each outcome once, but a solution is there twice; restore the "
                    "files, or begin the run again from its start."
                )
            archive._append(block, digests)
        return archive

    def add(self, solutions: NDArray[np.float64], values: Values, *, evaluation: int) -> Outcomes:
        """Take a generation.

        After an error nothing has changed.

        Args:
            solutions: (N, dim) float64.
            values: What they came to, with the passive columns of a `MotionEvaluator`.
            evaluation: Number of the evaluation of the first of them, from 0.

        Returns:
            What of it is new, as `write_segment` writes it.

        Raises:
            OutcomeError: Their numbers differ, a passive column is missing or of another form,
                fitness functions or descriptors are others than before, or evaluations went back.
        """
        _check(solutions, values)
        approved = np.flatnonzero(values.success | values.passive[EXPERT])
        fresh: dict[bytes, int] = {}
        for row, digest in zip(approved.tolist(), _digests(solutions[approved]), strict=True):
            if digest not in self._known:
                fresh.setdefault(digest, row)
        rows = np.array([*fresh.values()], np.intp)
        block = _block(rows, solutions, values, first=evaluation)
        check_outcomes(block)
        self._append(block, list(fresh))
        return block

    @property
    def figures(self) -> OutcomeFigures:
        """How many there are; it takes no longer when there are more."""
        return OutcomeFigures(
            both=int(self._counts[1, 1]),
            success_only=int(self._counts[1, 0]),
            expert_only=int(self._counts[0, 1]),
            cells=len(self._cells),
            outside=self._outside,
        )

    def outcomes(self) -> Outcomes:
        """Return all outcomes, in the order of their evaluation.

        Raises:
            OutcomeError: It was told no generation.
        """
        if not self._blocks:
            raise OutcomeError("Expected at least one generation, but got none; tell it one first.")
        return join(self._blocks)

    def to_bytes(self) -> bytes:
        """Return all outcomes as the contents of one compressed npz file.

        Equal outcomes give equal bytes, in whatever blocks they came. `load_outcomes` reads them.

        Raises:
            OutcomeError: It was told no generation.
        """
        return to_bytes(self.outcomes())

    def _append(self, block: Outcomes, digests: list[bytes]) -> None:
        if self._blocks:
            check_same_form(self._blocks[0], block)
            check_order(self._blocks[-1], block)
        expert = block[EXPERT]
        cells = self._ground_truth.cells(block[GROUND_TRUTH][expert])
        # One without rows says only which columns there are.
        if len(digests) or not self._blocks:
            self._blocks.append(block)
        self._known.update(digests)
        np.add.at(self._counts, (block["success"].astype(np.intp), expert.astype(np.intp)), 1)
        self._cells.update(cells[cells >= 0].tolist())
        self._outside += int((cells < 0).sum())


def _check(solutions: NDArray[np.float64], values: Values) -> None:
    if len(solutions) != len(values):
        raise OutcomeError(
            f"Expected the values of {len(solutions)} solutions, but got {len(values)}; pass one "
            "for each."
        )
    for name in (EXPERT, GROUND_TRUTH, DIGEST):
        if name not in values.passive:
            raise OutcomeError(
                f"Expected the passive column {name!r} among the values, but there are only "
                f"{', '.join(values.passive) or 'none'}; evaluate with a MotionEvaluator."
            )


def _block(
    rows: NDArray[np.intp], solutions: NDArray[np.float64], values: Values, *, first: int
) -> Outcomes:
    return {
        "solution": solutions[rows],
        "evaluation": first + rows.astype(np.int64),
        "success": values.success[rows],
        **{name: values.passive[name][rows] for name in (EXPERT, GROUND_TRUTH, DIGEST)},
        **{f"{FITNESS}{name}": column[rows] for name, column in values.fitness.items()},
        **{f"{MEASURES}{name}": column[rows] for name, column in values.measures.items()},
    }


def _digests(solutions: NDArray[np.float64]) -> list[bytes]:
    # Adding zero makes -0.0 the 0.0 that it equals.
    rows = solutions + 0.0
    return [hashlib.blake2b(row.tobytes(), digest_size=16).digest() for row in rows]
