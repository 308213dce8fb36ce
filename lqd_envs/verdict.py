"""What became of a motion before it is judged."""

from enum import IntEnum

DEEPEST_CONTACT = 0.003
"""Depth of a contact, in m, beyond which a motion is discarded at any control step."""
FASTEST_OBJECT = 2.0
"""Speed of the object's farthest point, in m/s, beyond which a motion is discarded."""


class Verdict(IntEnum):
    """Whether a motion may be judged, or why not.

    A rejected motion is never simulated; a discarded one was simulated, and shows what no real
    contact does. Both count as evaluations, and neither is ever inserted into an archive.
    """

    VALID = 0
    """May be judged."""
    UNREACHABLE = 1
    """Rejected: inverse kinematics found no arm configuration for its start pose."""
    OVERLAPPING = 2
    """Rejected: robot and scene interpenetrate at its start."""
    DIVERGED = 3
    """Discarded: the simulation raised a warning."""
    PENETRATING = 4
    """Discarded: two bodies were more than 3 mm inside each other at a control step."""
    TOO_FAST = 5
    """Discarded: the object's farthest point was faster than 2 m/s at a control step."""

    @property
    def rejected(self) -> bool:
        """Whether the motion failed before simulation."""
        return self in (Verdict.UNREACHABLE, Verdict.OVERLAPPING)

    @property
    def discarded(self) -> bool:
        """Whether the motion failed in simulation."""
        return self in (Verdict.DIVERGED, Verdict.PENETRATING, Verdict.TOO_FAST)
