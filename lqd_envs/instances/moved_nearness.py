"""The dense reward's nearness where the object does not stand where its task puts it."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from lqd_envs.instances.scene_change import SceneChange
from lqd_envs.perception import Columns, Vector3
from lqd_envs.tasks.task import ShapedReward


@dataclass(frozen=True)
class MovedNearness:
    """A task's nearness, asked as if object and gripper were moved back; a `ShapedReward` itself.

    Only their positions are moved back: a nearness that looks at orientations, which that of no
    task here does, sees those of the turned object.

    Attributes:
        nearness: The task's own.
        center: The task's centre, m, world frame.
        change: How the object was moved and turned.
    """

    nearness: ShapedReward
    center: Vector3
    change: SceneChange

    def __call__(self, columns: Columns) -> NDArray[np.float64]:
        """Return (N,) float64 in [0, 1]: how near the last moment is to a success."""
        return self.nearness(
            replace(
                columns,
                gripper_position=self._back(columns.gripper_position),
                object_position=self._back(columns.object_position),
            )
        )

    def _back(self, positions: NDArray[np.float64]) -> NDArray[np.float64]:
        center = np.array(self.center)
        turn = Rotation.from_euler("z", -self.change.turn).as_matrix()
        return np.asarray((positions - center - (*self.change.shift, 0.0)) @ turn.T + center)
