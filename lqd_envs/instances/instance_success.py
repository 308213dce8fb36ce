"""What counts as a success in an instance."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from lqd_envs.instances.approach_limit import ApproachLimit
from lqd_envs.instances.predicate import Predicate
from lqd_envs.perception import Columns
from lqd_envs.tasks.task import ExpertSuccess


@dataclass(frozen=True)
class InstanceSuccess:
    """The expert's success and what an instance asks beside it; an `ExpertSuccess` itself.

    Attributes:
        expert: The task's own success condition.
        predicate: Condition on the motion, or None.
        approach: Limit on where the gripper comes from, or None.
    """

    expert: ExpertSuccess
    predicate: Predicate | None
    approach: ApproachLimit | None

    def __call__(self, columns: Columns) -> NDArray[np.bool_]:
        """Return (N,) bool: does the last moment, given the first, show a success?"""
        success = np.asarray(self.expert(columns))
        for condition in (self.predicate, self.approach):
            if condition is not None:
                success = success & condition.holds(columns)
        return success
