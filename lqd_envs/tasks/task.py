"""A task: an instruction, a scene, an expert's success condition and a ground-truth descriptor."""

from collections.abc import Callable
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from lqd_envs.perception import Columns, PerceptionSchema, Vector3

SceneBuilder = Callable[[], mujoco.MjSpec]
ExpertSuccess = Callable[[Columns], NDArray[np.bool_]]
"""(N, T, ...) columns to (N,) bool: does the last moment, given the first, show a success?"""
ShapedReward = Callable[[Columns], NDArray[np.float64]]
"""(N, T, ...) columns to (N,) float64 in [0, 1]: how near the last moment is to a success."""
ExpertDescriptor = Callable[[Columns], NDArray[np.float64]]
"""(N, T, ...) columns to (N, d) float64; a row of NaN where it is not defined."""


@dataclass(frozen=True)
class GroundTruth:
    """The ground-truth descriptor of a task and the grid in which its coverage is counted.

    Only what is reported uses it; no search and no functional ever sees it.

    Attributes:
        descriptor: What places a motion in the grid.
        names: Name and unit of each measure.
        dims: Cells along each dimension.
        ranges: Lower and upper bound along each dimension.
    """

    descriptor: ExpertDescriptor
    names: tuple[str, ...]
    dims: tuple[int, ...]
    ranges: tuple[tuple[float, float], ...]

    def cells(self, measures: NDArray[np.float64]) -> NDArray[np.int64]:
        """Return the grid cell of each row of measures.

        Args:
            measures: (N, d) float64; NaN where undefined.

        Returns:
            (N,) int64: the flat (C order) index of the cell; -1 outside the grid or undefined.
        """
        low, high = np.asarray(self.ranges, dtype=np.float64).T
        dims = np.asarray(self.dims)
        inside = ((measures >= low) & (measures <= high)).all(axis=1)
        position = np.where(inside[:, None], (measures - low) / (high - low), 0.0)
        index = np.minimum((position * dims).astype(np.int64), dims - 1)
        flat = np.ravel_multi_index(tuple(index.T), self.dims)
        return np.where(inside, flat, -1)


@dataclass(frozen=True)
class Task:
    """One manipulation task.

    Attributes:
        id: Name under which its Gymnasium env is registered, such as `LQD/Faucet-v0`.
        instruction: The sentence that a language model is given.
        schema: Names with which the task fills the perception API.
        center: Where start positions are centred, in m, world frame.
        build_scene: Makes the scene, sensors aside.
        base: Body of the scene whose frame is the object's base.
        fast_points: Sites of the scene on the object whose speed is watched.
        success: The expert's success condition.
        nearness: How near a moment is to a success: the shaped part of the dense reward.
        ground_truth: The ground-truth descriptor and its grid.
    """

    id: str
    instruction: str
    schema: PerceptionSchema
    center: Vector3
    build_scene: SceneBuilder
    base: str
    fast_points: tuple[str, ...]
    success: ExpertSuccess
    nearness: ShapedReward
    ground_truth: GroundTruth

    @property
    def name(self) -> str:
        """Short lower-case name, such as `faucet`."""
        return self.id.rpartition("/")[2].partition("-")[0].lower()
