"""The predicate that a joint of the object ends within a band."""

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from lqd_envs.instances.instance_error import InstanceError
from lqd_envs.instances.numbers import checked_band
from lqd_envs.perception import Columns
from lqd_envs.tasks.task import Task

_WIDEST = (0.0, 10.0)


@dataclass(frozen=True)
class JointBand:
    """A joint of the object is within a band of positions at the end of the motion.

    A position outside the joint's range counts as the end of the range that it was pressed
    against: stops yield a little.

    Attributes:
        joint: The joint's name, a key of `Info.joint_positions`.
        low: Least position, rad or m; 0 is closed.
        high: Greatest position, rad or m.
        kind: Tells predicates apart in JSON.
    """

    joint: str
    low: float
    high: float
    kind: Literal["joint_band"] = field(default="joint_band", init=False)

    def __post_init__(self) -> None:
        if not isinstance(self.joint, str):
            raise InstanceError(
                f"Expected `joint` to be the name of a joint, but got {self.joint!r}; name one, "
                "such as 'hot_tap'."
            )
        low, high = checked_band(self, low="low", high="high", within=_WIDEST)
        object.__setattr__(self, "low", low)
        object.__setattr__(self, "high", high)

    def require_fits(self, task: Task) -> None:
        """Raise `InstanceError` where the task's object has no such joint, or it ends below."""
        joints = {joint.name: joint for joint in task.schema.joints}
        joint = joints.get(self.joint)
        if joint is None:
            raise InstanceError(
                f"Expected a joint of {task.id}, but got {self.joint!r}; its joints are: "
                f"{', '.join(joints) or 'none'}."
            )
        if self.low > joint.upper:
            raise InstanceError(
                f"Expected a band that {joint.name} of {task.id} reaches, which goes from 0 to "
                f"{joint.upper:.4g} {joint.unit}, but got one from {self.low:g} to {self.high:g}; "
                "lower the band."
            )

    def holds(self, columns: Columns) -> NDArray[np.bool_]:
        """Return (N,) bool: whether the joint is within the band at the last moment."""
        index = [joint.name for joint in columns.schema.joints].index(self.joint)
        upper = columns.schema.joints[index].upper
        position = np.clip(columns.joint_positions[:, -1, index], 0.0, upper)
        return np.asarray((position >= self.low) & (position <= self.high))
