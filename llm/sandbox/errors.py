"""The errors that the sandbox raises on purpose."""

from lqd_envs.errors import LQDError


class SandboxError(LQDError):
    """The sandbox cannot do what was asked of it."""


class RejectedCodeError(SandboxError):
    """A function was refused by the static check, before any of it ran.

    Args:
        reason: What is wrong, in words that the code can be repaired by.
        line: Line of the code that it is about, counted from 1; None: the code as a whole.

    Attributes:
        reason: As given.
        line: As given.
    """

    def __init__(self, reason: str, *, line: int | None = None) -> None:
        self.reason = reason
        self.line = line
        place = f"line {line}" if line else "the code"
        super().__init__(
            f"Expected code that the sandbox allows, but {place} is refused: {reason}."
        )
