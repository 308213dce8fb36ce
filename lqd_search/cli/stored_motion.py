"""A motion that a run kept, as an elite of its archive or as one of its outcomes."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lqd_envs import LQDError
from lqd_search.archives.worth import worth_of
from lqd_search.runs.replay import Replay
from lqd_search.runs.stored_archive import StoredArchive
from lqd_search.runs.stored_outcomes import FITNESS, Outcomes


@dataclass(frozen=True, eq=False)
class StoredMotion:
    """A motion that a run kept, and what the run saw of it.

    Attributes:
        title: Which one it is, such as `elite 3 of 120`.
        solution: (9,) the solution.
        evaluation: Number of its evaluation, from 0.
        fitness: By name; an elite has one, its objective.
        success: Whether the run's own condition approved it.
        expert: Whether the expert's condition approved it.
        digest: Fingerprint of its perception.
    """

    title: str
    solution: NDArray[np.float64]
    evaluation: int
    fitness: Mapping[str, float]
    success: bool
    expert: bool
    digest: int

    @classmethod
    def elite(cls, archive: StoredArchive, row: int) -> "StoredMotion":
        """Return an elite of an archive.

        Raises:
            LQDError: There is no such row.
        """
        _check_row("elites in the archive", row, len(archive))
        fitness = {"fitness": archive.fields["objective"]}
        return cls._of(archive.fields, row, title=f"elite {row} of {len(archive)}", fitness=fitness)

    @classmethod
    def outcome(cls, outcomes: Outcomes, row: int) -> "StoredMotion":
        """Return one of a run's distinct successes.

        Raises:
            LQDError: There is no such row.
        """
        n = len(outcomes["solution"])
        _check_row("outcomes", row, n)
        fitness = {
            f"fitness {name.removeprefix(FITNESS)}": column
            for name, column in outcomes.items()
            if name.startswith(FITNESS)
        }
        return cls._of(outcomes, row, title=f"outcome {row} of {n}", fitness=fitness)

    def is_same(self, shown: Replay) -> bool:
        """Return whether a replay is, bit for bit, what the run saw of this motion."""
        same_infos = shown.same_as_batch and shown.digest == self.digest
        return same_infos and shown.success == self.expert

    def report(self, shown: Replay) -> str:
        """Return a few lines that say what a replay came to, beside what the run saw."""
        scores = "".join(f", {name} {value:.6g}" for name, value in self.fitness.items())
        end = shown.infos[-1]
        gripper = np.array2string(np.asarray(end["gripper_position"]), precision=3, separator=", ")
        joints = [f"{name} {value:.4f}" for name, value in end["joint_positions"].items()]
        return "\n".join(
            [
                f"{self.title}, evaluation {self.evaluation}{scores}",
                f"solution: {np.array2string(self.solution, precision=4, separator=', ')}",
                f"success: {_yes(shown.success)} by the expert's condition (in the run: "
                f"{_yes(self.expert)}; by the inferred one: {_yes(self.success)})",
                f"infos equal to a batch rollout's, bit for bit: {_yes(shown.same_as_batch)}",
                "infos equal to those of the run, bit for bit: "
                f"{_yes(shown.digest == self.digest)}",
                f"at the end: {', '.join([*joints, f'gripper at {gripper} m'])}",
            ]
        )

    @classmethod
    def _of(
        cls,
        columns: Mapping[str, NDArray[Any]],
        row: int,
        *,
        title: str,
        fitness: Mapping[str, NDArray[np.float64]],
    ) -> "StoredMotion":
        return cls(
            title=title,
            solution=columns["solution"][row],
            evaluation=int(columns["evaluation"][row]),
            fitness={name: float(column[row]) for name, column in fitness.items()},
            success=bool(columns["success"][row]),
            expert=bool(columns["expert"][row]),
            digest=int(columns["digest"][row]),
        )


def best_success(archive: StoredArchive) -> int:
    """Return the row of the success of the highest fitness, by the inferred condition.

    Raises:
        LQDError: The archive holds no success.
    """
    success, objective = archive.fields["success"], archive.fields["objective"]
    if not success.any():
        raise LQDError(
            f"Expected a success in the archive, but none of its {len(archive)} elites is one by "
            "the condition that steered it; choose an elite with --index, or search longer."
        )
    candidates = np.flatnonzero(success)
    return int(candidates[np.argmax(worth_of(objective[candidates]))])


def _check_row(what: str, row: int, n: int) -> None:
    if row >= n:
        raise LQDError(
            f"Expected an index below {n}, the number of {what}, got {row}; choose "
            f"{'a lower one' if n else 'another run'}."
        )


def _yes(answer: bool) -> str:
    return "yes" if answer else "no"
