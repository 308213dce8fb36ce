"""Where each env of a vectorised environment is in its episode."""

from dataclasses import dataclass

import numpy as np
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray

from lqd_envs.errors import LQDError
from lqd_envs.inputs import ResetError, named_envs

_Bools = NDArray[np.bool_]


@dataclass(frozen=True)
class Episodes:
    """The episodes of a vectorised environment, changed in place as they go on.

    Attributes:
        limit: Control steps after which an episode is over; None: never.
        started: (num_envs,) bool: which envs have started.
        over: (num_envs,) bool: whose episode ended at the last step.
        discarded: (num_envs,) bool: where nothing counts as a success until the next start.
        elapsed: (num_envs,) int64: control steps since the start.
    """

    limit: int | None
    started: _Bools
    over: _Bools
    discarded: _Bools
    elapsed: NDArray[np.int64]

    @classmethod
    def of(cls, num_envs: int, *, limit: int | None) -> "Episodes":
        """Return the episodes of envs that have not started."""
        return cls(
            limit=limit,
            started=np.zeros(num_envs, dtype=bool),
            over=np.zeros(num_envs, dtype=bool),
            discarded=np.zeros(num_envs, dtype=bool),
            elapsed=np.zeros(num_envs, dtype=np.int64),
        )

    def start(self, envs: NDArray[np.intp], *, discarded: _Bools) -> None:
        """Begin anew in some envs.

        Args:
            envs: (n,) the envs.
            discarded: (n,) which of their starts are discarded already.
        """
        self.started[envs] = True
        self.over[envs] = False
        self.discarded[envs] = discarded
        self.elapsed[envs] = 0

    def go_on(self, stepped: _Bools, *, spoiled: _Bools, diverged: _Bools) -> None:
        """Take note of one control step.

        Args:
            stepped: (num_envs,) which envs were stepped; the others were just started.
            spoiled: (num_envs,) whose present moment no motion may lead through.
            diverged: (num_envs,) whose simulation diverged.
        """
        self.elapsed[stepped] += 1
        np.logical_or(self.discarded, spoiled | diverged, out=self.discarded)
        late = self.elapsed >= self.limit if self.limit is not None else np.zeros_like(stepped)
        self.over[:] = stepped & (diverged | late)

    def require_started(self, caller: str) -> None:
        """Raise `LQDError` in the name of a method where an env has not started."""
        missing = np.flatnonzero(~self.started)
        if len(missing):
            raise LQDError(
                f"expected reset() before {caller}(), but {named_envs(missing)} did not start: "
                "call envs.reset() once"
            )

    def require_others_started(self, mask: _Bools) -> None:
        """Raise `ResetError` where an env outside the mask has not started."""
        missing = np.flatnonzero(~self.started & ~mask)
        if len(missing):
            raise ResetError(
                "expected the option 'reset_mask' to pick every env that was not started yet, "
                f"but {named_envs(missing)} would be left out: reset those too"
            )

    def require_ready(self, mode: AutoresetMode) -> None:
        """Raise `LQDError` where an env must be reset before the next step."""
        self.require_started("step")
        if mode is AutoresetMode.DISABLED and self.over.any():
            raise LQDError(
                f"expected {named_envs(np.flatnonzero(self.over))} to be reset after the end of "
                'an episode, since autoreset is disabled: call envs.reset(options={"reset_mask": '
                "terminations | truncations})"
            )
