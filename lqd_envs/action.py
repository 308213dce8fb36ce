"""The action: seven joint targets and the finger opening, each in [-1, 1]."""

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

from lqd_envs.scenes.panda import ARM_JOINTS, FINGER_OPEN, FINGER_SQUEEZE

ACTION_DIM = 8
CONTROL_STEP = 0.02
"""Time from one action to the next, in s."""


@dataclass(frozen=True)
class ActionMap:
    """The affine map between actions and controls, the one that every way of simulating uses.

    Attributes:
        low: (8,) float64, controls at -1: joint targets in rad, finger target in m.
        high: (8,) float64, controls at +1.
    """

    low: NDArray[np.float64]
    high: NDArray[np.float64]

    @classmethod
    def of(cls, model: mujoco.MjModel) -> "ActionMap":
        """Return the map onto the joint limits of `model` and the range of the finger targets."""
        limits = np.array([model.joint(name).range for name in ARM_JOINTS])
        return cls(
            low=np.append(limits[:, 0], FINGER_SQUEEZE), high=np.append(limits[:, 1], FINGER_OPEN)
        )

    def controls(self, actions: ArrayLike) -> NDArray[np.float64]:
        """Return the controls of the nine actuators.

        Args:
            actions: (..., 8) in [-1, 1]; values outside are clipped.

        Returns:
            (..., 9) float64: seven joint targets in rad, then both fingers' target in m.
        """
        clipped = np.clip(np.asarray(actions, dtype=np.float64), -1.0, 1.0)
        middle, half = self._middle_and_half()
        targets = middle + half * clipped
        return np.concatenate([targets, targets[..., -1:]], axis=-1)

    def actions(
        self, joint_targets: NDArray[np.float64], *, finger_target: NDArray[np.float64]
    ) -> NDArray[np.float32]:
        """Return the actions that ask for given targets, rounded to float32.

        Args:
            joint_targets: (..., 7) in rad.
            finger_target: (...,) in m, of each finger.

        Returns:
            (..., 8) float32 in [-1, 1].
        """
        targets = np.concatenate([joint_targets, finger_target[..., None]], axis=-1)
        middle, half = self._middle_and_half()
        return np.clip((targets - middle) / half, -1.0, 1.0).astype(np.float32)

    def _middle_and_half(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        return (self.high + self.low) / 2.0, (self.high - self.low) / 2.0
