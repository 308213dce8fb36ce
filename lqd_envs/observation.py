"""The observation: what a policy is given, as one vector."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from lqd_envs.perception import Columns
from lqd_envs.scene import Scene
from lqd_envs.scenes.panda import ARM_JOINTS, FINGER_OPEN

_WORKSPACE = 2.0
_FASTEST_JOINT = 10.0
_MARGIN = 0.1


@dataclass(frozen=True)
class Observation:
    """The layout of a task's observation and its bounds.

    Attributes:
        names: (d,) name and unit of every entry.
        low: (d,) float64 lower bounds.
        high: (d,) float64 upper bounds.
    """

    names: tuple[str, ...]
    low: NDArray[np.float64]
    high: NDArray[np.float64]

    @classmethod
    def of(cls, scene: Scene) -> "Observation":
        """Return the layout for a task's scene."""
        entries: list[tuple[str, float, float]] = []
        for name in ARM_JOINTS:
            low, high = scene.model.joint(name).range
            entries.append((f"position of {name} (rad)", low - _MARGIN, high + _MARGIN))
        entries += [
            (f"velocity of {name} (rad/s)", -_FASTEST_JOINT, _FASTEST_JOINT) for name in ARM_JOINTS
        ]
        entries += [(f"position of the {side} finger (m)", -0.01, FINGER_OPEN + 0.01)
                    for side in ("left", "right")]  # fmt: skip
        for frame in ("gripper", "object"):
            entries += [(f"{frame} {axis} (m)", -_WORKSPACE, _WORKSPACE) for axis in "xyz"]
            entries += [(f"{frame} quaternion {part}", -1.0, 1.0) for part in "wxyz"]
        for joint in scene.task.schema.joints:
            entries.append((f"{joint.name} ({joint.unit})", -_MARGIN, joint.upper + _MARGIN))
        entries += [("object touches table", 0.0, 1.0), ("robot touches table", 0.0, 1.0)]
        entries += [(f"gripper touches {link}", 0.0, 1.0) for link in scene.task.schema.links]
        names, low, high = zip(*entries, strict=True)
        return cls(names=names, low=np.array(low), high=np.array(high))

    def vector(
        self,
        scene: Scene,
        *,
        qpos: NDArray[np.float64],
        qvel: NDArray[np.float64],
        sensordata: NDArray[np.float64],
        columns: Columns,
    ) -> NDArray[np.float64]:
        """Return the observations of N simulations.

        Args:
            scene: The task's scene.
            qpos: (N, nq) joint positions.
            qvel: (N, nv) joint velocities.
            sensordata: (N, nsensordata) sensor values.
            columns: (N, T, ...) perception, of which the last moment is observed.

        Returns:
            (N, d) float64, clipped to the bounds.
        """
        sensors = scene.sensors
        vector = np.concatenate(
            [
                qpos[:, scene.arm_qpos],
                qvel[:, scene.arm_qvel],
                qpos[:, scene.finger_qpos],
                columns.gripper_position[:, -1],
                sensors.quaternion(sensordata, "gripper_orientation"),
                columns.object_position[:, -1],
                sensors.quaternion(sensordata, "object_orientation"),
                columns.joint_positions[:, -1],
                columns.object_table_contact[:, -1:],
                columns.robot_table_contact[:, -1:],
                columns.gripper_contacts[:, -1],
            ],
            axis=1,
        )
        return np.asarray(np.clip(vector, self.low, self.high))
