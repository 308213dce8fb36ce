"""What a function that runs in the sandbox is asked for."""

from enum import StrEnum


class Role(StrEnum):
    """What a function is given, and what it must return."""

    SUCCESS = "success"
    """The infos of a motion; returns a bool."""
    FITNESS = "fitness"
    """One info; returns a finite number. It is called on every info, and the mean is taken."""
    TIMESTAMP = "timestamp"
    """The infos; returns one of them, or None."""
    QUANTITY = "quantity"
    """One info that a timestamp picked; returns a tuple or list of 2 to 5 finite numbers."""
    DESCRIPTOR = "descriptor"
    """The infos; returns a tuple or list of 2 to 5 finite numbers, or None."""
