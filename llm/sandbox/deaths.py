"""Workers that died without having used too much, and whether a function is to blame."""

from lqd_llm.sandbox.errors import SandboxError

DEATHS = 3
"""In a row, at the same place: whoever was running there is at fault."""
VAIN_DEATHS = 30
"""In a row, without a single motion done in between."""


class Deaths:
    """Deaths of workers since anybody was dropped, at one place and in all."""

    def __init__(self) -> None:
        self._place = (-1, -1)
        self._here = 0
        self._motion = -1
        self._vain = 0

    def count(self, function: int, motion: int) -> int:
        """Note a death, and return how many in a row there were at this place.

        Args:
            function: Index of the function that was running, or `NO_FUNCTION`.
            motion: The motion that it was running on.
        """
        self._here = self._here + 1 if (function, motion) == self._place else 1
        self._place = (function, motion)
        return self._here

    def give_up_when_vain(self, motion: int) -> None:
        """Note a death, and see whether going on makes sense.

        Args:
            motion: The motion that was not done.

        Raises:
            SandboxError: Workers die again and again, and no function is at fault.
        """
        self._vain = self._vain + 1 if motion == self._motion else 1
        self._motion = motion
        if self._vain >= VAIN_DEATHS:
            raise SandboxError(
                f"Expected the sandbox's worker to go on, but it died {self._vain} times in a row "
                "without getting any further, and no function is at fault; see whether the system "
                "ends processes, for want of memory say."
            )
