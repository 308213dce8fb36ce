"""The recorded columns of a batch of motions."""

from dataclasses import dataclass
from hashlib import blake2b

import numpy as np
from numpy.typing import NDArray

from lqd_envs.errors import LQDError
from lqd_envs.motion import MotionPlan
from lqd_envs.perception import Columns, Infos
from lqd_envs.tasks.task import Task
from lqd_envs.verdict import Verdict


@dataclass(frozen=True)
class Trajectories:
    """What N motions looked like, one row each.

    Attributes:
        task: The task they were tried in.
        solutions: (N, 9) float64.
        plan: Their start configurations and actions.
        verdicts: (N,) uint8, a `Verdict` each.
        columns: (N, 76, ...) perception at every control step; zero where it was rejected.
        obstructed: (N,) bool: whether the robot touched an obstacle at a control step; None where
            the scene has no obstacles.
    """

    task: Task
    solutions: NDArray[np.float64]
    plan: MotionPlan
    verdicts: NDArray[np.uint8]
    columns: Columns
    obstructed: NDArray[np.bool_] | None = None

    def __len__(self) -> int:
        """Return the number of motions."""
        return len(self.solutions)

    @property
    def valid(self) -> NDArray[np.bool_]:
        """(N,) bool: which motions may be judged."""
        return np.asarray(self.verdicts == Verdict.VALID)

    def rows(self, rows: NDArray[np.intp]) -> "Trajectories":
        """Return the chosen motions alone."""
        return Trajectories(
            task=self.task,
            solutions=self.solutions[rows],
            plan=MotionPlan(
                verdicts=self.plan.verdicts[rows],
                starts=self.plan.starts[rows],
                actions=self.plan.actions[rows],
            ),
            verdicts=self.verdicts[rows],
            columns=self.columns.rows(rows),
            obstructed=None if self.obstructed is None else self.obstructed[rows],
        )

    def infos(self, i: int) -> Infos:
        """Return motion `i` as the functionals see it: 76 dictionaries, from start to end.

        Raises:
            LQDError: The motion was never simulated.
        """
        verdict = Verdict(int(self.verdicts[i]))
        if verdict.rejected:
            raise LQDError(
                f"expected a motion that was simulated, got motion {i}, which was rejected as "
                f"{verdict.name.lower()}: ask only for motions whose verdict is not a rejection"
            )
        return self.columns.infos(i)

    def success(self) -> NDArray[np.bool_]:
        """Return (N,) bool: the expert's word on each motion; False where it failed before.

        A motion that touched an obstacle is none: a real robot would have stopped there.
        """
        success = np.asarray(self.task.success(self.columns)) & self.valid
        return success if self.obstructed is None else success & ~self.obstructed

    def ground_truth(self) -> NDArray[np.float64]:
        """Return (N, d) float64: the ground-truth measures; NaN where undefined or not valid."""
        measures = self.task.ground_truth.descriptor(self.columns)
        return np.where(self.valid[:, None], measures, np.nan)

    def digests(self) -> NDArray[np.uint64]:
        """Return (N,) uint64: a fingerprint of each motion's perception, every bit of it.

        Two motions have the same fingerprint if their infos are equal bit for bit, and else, for
        all that matters, not. A motion that was rejected has 0.
        """
        arrays = self.columns.arrays().values()
        digests = np.zeros(len(self), dtype=np.uint64)
        for i in np.flatnonzero(self.simulated):
            digest = blake2b(digest_size=8)
            for array in arrays:
                digest.update(array[i].tobytes())
            digests[i] = np.frombuffer(digest.digest(), dtype="<u8")[0]
        return digests

    @property
    def simulated(self) -> NDArray[np.bool_]:
        """(N,) bool: which motions were not rejected."""
        return ~np.isin(self.verdicts, [int(v) for v in Verdict if v.rejected])
