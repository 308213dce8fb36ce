"""The expert as judge: success, fitness and descriptor written by the task's author."""

import numpy as np
from numpy.typing import NDArray

from lqd_envs import Task, Trajectories
from lqd_search.archives.grid_spec import GridSpec
from lqd_search.evaluation.values import Values

EXPERT_FITNESS = "expert"
"""Name of the expert's fitness."""
EXPERT_DESCRIPTOR = "ground_truth"
"""Name of the expert's descriptor, the ground truth."""


class ExpertJudge:
    """Judges by the task's own success condition, shaped nearness and ground-truth descriptor.

    Only the handcrafted baseline is steered by it; no inferred functional meets what it knows. Its
    fitness, in [0, 1], is the mean over a motion's moments of the task's nearness to a success, the
    shaped part of the env's dense reward. It implements `Judge`.

    Args:
        task: The task.

    Attributes:
        fitness_names: `("expert",)`.
        descriptors: `ground_truth` with its number of measures.
        dropped: Empty.
    """

    def __init__(self, task: Task) -> None:
        self._task = task
        self.fitness_names: tuple[str, ...] = (EXPERT_FITNESS,)
        self.descriptors = {EXPERT_DESCRIPTOR: len(task.ground_truth.dims)}
        self.dropped: tuple[str, ...] = ()

    @property
    def grids(self) -> dict[str, GridSpec]:
        """The ground-truth grid, by the descriptor's name."""
        truth = self._task.ground_truth
        return {EXPERT_DESCRIPTOR: GridSpec(dims=truth.dims, ranges=truth.ranges)}

    def __call__(self, trajectories: Trajectories) -> Values:
        """Judge N motions; what failed before it was judged has a NaN fitness and no measures."""
        return Values(
            valid=trajectories.valid,
            success=trajectories.success(),
            fitness={EXPERT_FITNESS: self._mean_nearness(trajectories)},
            measures={EXPERT_DESCRIPTOR: trajectories.ground_truth()},
        )

    def _mean_nearness(self, trajectories: Trajectories) -> NDArray[np.float64]:
        columns = trajectories.columns
        moments = columns.gripper_position.shape[1]
        # NumPy's mean adds in another order where there is a single motion.
        total = np.zeros(len(trajectories))
        for t in range(moments):
            total += self._task.nearness(columns.until(t))
        return np.where(trajectories.valid, total / moments, np.nan)
