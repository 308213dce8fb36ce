"""What a function in the sandbox may use."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Limits:
    """What a function may use before it is stopped and dropped.

    Attributes:
        cpu_seconds: CPU time of one function on one motion, in s; a quantity may use as much at
            each moment that the timestamps pick, since it is called once for each. It is the
            worker's own clock, so a busy machine changes nothing.
        memory_bytes: Memory that the worker may take, beyond what it has before the first function.
        idle_seconds: Time on the wall without any progress of the worker's CPU clock after which it
            is replaced, in s. Only somebody else can make it stand still, so no function is blamed
            unless that happens where it runs three times in a row.
    """

    cpu_seconds: float = 1.0
    memory_bytes: int = 1 << 30
    idle_seconds: float = 60.0
