"""The space of solutions: nine numbers that stand for one motion primitive."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lqd_envs.errors import LQDError

Solutions = NDArray[np.float64]

SOLUTION_NAMES = ("x", "y", "z", "roll", "pitch", "yaw", "dx", "dy", "dz")
POSITION_UNIT = 0.10
"""Length of one unit of x, y, z, in m: the start lies in a cube of 20 cm around the centre."""
MOTION_UNIT = 0.20
"""Length of one unit of dx, dy, dz, in m."""
SHORTEST_MOTION = 0.25
"""Least length of (dx, dy, dz): 5 cm; the greatest is 1: 20 cm."""

_HALF_TURN = np.pi
_QUARTER_TURN = np.pi / 2.0
# A rescaled vector must not end a rounding error outside the bounds that it was scaled to.
_INWARDS = 1e-15


class SolutionError(LQDError, ValueError):
    """Solutions of a wrong shape, with numbers that are not finite, or outside the space."""


@dataclass(frozen=True)
class SolutionSpace:
    """Solutions `[x, y, z, roll, pitch, yaw, dx, dy, dz]`.

    Position: where the midpoint of the fingertips starts, relative to the task's centre, in units
    of 0.10 m, each in [-1, 1]. Orientation: rad, zero when the fingers point straight down, roll
    and pitch in [-pi/2, pi/2], yaw in [-pi, pi): every direction that is not above the horizontal.
    Motion: in units of 0.20 m, of length 0.25 to 1, with dz >= 0.

    Attributes:
        position_std: Standard deviation of the mutation of x, y, z (the paper's).
        orientation_std: The same of roll, pitch and yaw, in rad (the paper's).
        motion_std: The same of dx, dy, dz (the paper gives none).
    """

    position_std: float = 0.15
    orientation_std: float = 0.3
    motion_std: float = 0.15

    @property
    def dim(self) -> int:
        """Length of a solution: 9."""
        return len(SOLUTION_NAMES)

    @property
    def lower(self) -> NDArray[np.float64]:
        """(9,) float64: the lower bounds of the box around the space."""
        return np.array([*[-1.0] * 3, *[-_QUARTER_TURN] * 2, -_HALF_TURN, -1.0, -1.0, 0.0])

    @property
    def upper(self) -> NDArray[np.float64]:
        """(9,) float64: the upper bounds of the box around the space."""
        return np.array([*[1.0] * 3, *[_QUARTER_TURN] * 2, _HALF_TURN, *[1.0] * 3])

    def sample(self, n: int, *, rng: np.random.Generator) -> Solutions:
        """Draw solutions: uniform positions, rotations, directions and lengths.

        Args:
            n: How many.
            rng: Source of randomness.

        Returns:
            (n, 9) float64. The rotations are uniform over the half of SO(3) whose fingers do not
            point above the horizontal, so the pitch is not uniform: its sine is.
        """
        position = rng.uniform(-1.0, 1.0, (n, 3))
        roll = rng.uniform(-_QUARTER_TURN, _QUARTER_TURN, n)
        pitch = np.arcsin(rng.uniform(-1.0, 1.0, n))
        yaw = rng.uniform(-_HALF_TURN, _HALF_TURN, n)
        up = rng.uniform(0.0, 1.0, n)
        heading = rng.uniform(-_HALF_TURN, _HALF_TURN, n)
        length = rng.uniform(SHORTEST_MOTION, 1.0, n)
        across = np.sqrt(1.0 - up * up)
        direction = np.stack([across * np.cos(heading), across * np.sin(heading), up], axis=-1)
        orientation = np.stack([roll, pitch, yaw], axis=-1)
        return self.repair(
            np.concatenate([position, orientation, direction * length[:, None]], axis=-1)
        )

    def mutate(self, parents: ArrayLike, *, rng: np.random.Generator) -> Solutions:
        """Return one repaired Gaussian mutant of each parent.

        Args:
            parents: (n, 9) solutions.
            rng: Source of randomness.

        Returns:
            (n, 9) float64, feasible.

        Raises:
            SolutionError: `parents` has another shape or a number that is not finite.
        """
        checked = self.validate(parents)
        stds = np.repeat([self.position_std, self.orientation_std, self.motion_std], 3)
        return self.repair(checked + stds * rng.standard_normal(checked.shape))

    def difference(self, solutions: ArrayLike, others: ArrayLike) -> Solutions:
        """Return what leads from other solutions to these, the shorter way round in yaw.

        Args:
            solutions: (n, 9), finite.
            others: (n, 9), finite.

        Returns:
            (n, 9) float64; added to `others` and repaired, it gives `solutions`, but for rounding.

        Raises:
            SolutionError: One of them has another shape or a number that is not finite.
        """
        difference = self.validate(solutions) - self.validate(others)
        difference[:, 5] = _wrap(difference[:, 5])
        return difference

    def repair(self, solutions: ArrayLike) -> Solutions:
        """Bring solutions back into the space.

        Positions are clipped. Orientations are turned into their canonical angles (the same
        rotation), then the roll is clipped. dz is clipped at 0, then the length; where nothing is
        left of the motion, it becomes 5 cm straight up. A feasible solution is left alone, bit
        for bit.

        Args:
            solutions: (n, 9), finite.

        Returns:
            (n, 9) float64, feasible.

        Raises:
            SolutionError: `solutions` has another shape or a number that is not finite.
        """
        checked = self.validate(solutions)
        return np.concatenate(
            [
                np.clip(checked[:, 0:3], -1.0, 1.0),
                _canonical_orientation(checked[:, 3:6]),
                _clip_motion(checked[:, 6:9]),
            ],
            axis=-1,
        )

    def feasible(self, solutions: ArrayLike) -> NDArray[np.bool_]:
        """Return (n,) bool: which solutions lie in the space.

        Args:
            solutions: (n, 9), finite.

        Raises:
            SolutionError: `solutions` has another shape or a number that is not finite.
        """
        checked = self.validate(solutions)
        length = _length(checked[:, 6:9])
        return np.asarray(
            (np.abs(checked[:, 0:3]) <= 1.0).all(axis=1)
            & (np.abs(checked[:, 3:5]) <= _QUARTER_TURN).all(axis=1)
            & (checked[:, 5] >= -_HALF_TURN)
            & (checked[:, 5] < _HALF_TURN)
            & (checked[:, 8] >= 0.0)
            & (length >= SHORTEST_MOTION)
            & (length <= 1.0)
        )

    def require_feasible(self, solutions: ArrayLike) -> Solutions:
        """Return `solutions` as an array, or say which of them lies outside the space.

        Args:
            solutions: What should be (n, 9) feasible solutions.

        Returns:
            (n, 9) float64.

        Raises:
            SolutionError: It is not.
        """
        checked = self.validate(solutions)
        outside = np.flatnonzero(~self.feasible(checked))
        if len(outside):
            raise SolutionError(
                f"expected feasible solutions, got {len(outside)} that are not, the first of them "
                f"solution {outside[0]}, {checked[outside[0]].tolist()}: bring them back with "
                "SolutionSpace().repair"
            )
        return checked

    def validate(self, solutions: ArrayLike) -> Solutions:
        """Return `solutions` as an array, or say what is wrong with them.

        Args:
            solutions: What should be (n, 9) finite numbers.

        Returns:
            (n, 9) float64.

        Raises:
            SolutionError: It is not.
        """
        try:
            array = np.asarray(solutions, dtype=np.float64)
        except (TypeError, ValueError, OverflowError) as error:
            raise SolutionError(
                f"expected solutions as an array of shape (n, {self.dim}), got something that is "
                f"not an array of numbers ({error}): pass one row "
                f"[{', '.join(SOLUTION_NAMES)}] for each motion"
            ) from error
        if array.ndim != 2 or array.shape[1] != self.dim:
            raise SolutionError(
                f"expected solutions of shape (n, {self.dim}), got {array.shape}: pass one row "
                f"[{', '.join(SOLUTION_NAMES)}] for each motion"
            )
        bad = np.argwhere(~np.isfinite(array))
        if len(bad):
            row, column = bad[0]
            raise SolutionError(
                f"expected finite numbers, got {array[row, column]} for "
                f"{SOLUTION_NAMES[column]} of solution {row}: remove or repair such rows first"
            )
        return array


def _wrap(angle: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the angle in [-pi, pi), untouched where it is there already."""
    wrapped = np.mod(angle + _HALF_TURN, 2.0 * _HALF_TURN) - _HALF_TURN
    # The remainder of a tiny negative number rounds up to the whole turn.
    wrapped = np.where(wrapped >= _HALF_TURN, -_HALF_TURN, wrapped)
    inside = (angle >= -_HALF_TURN) & (angle < _HALF_TURN)
    return np.where(inside, angle, wrapped)


def _canonical_orientation(orientation: NDArray[np.float64]) -> NDArray[np.float64]:
    roll, pitch, yaw = _wrap(orientation).T
    # (roll + pi, pi - pitch, yaw + pi) is the same rotation, with the pitch back in its range.
    beyond = np.abs(pitch) > _QUARTER_TURN
    pitch = np.where(beyond, np.copysign(_HALF_TURN, pitch) - pitch, pitch)
    roll = np.where(beyond, _wrap(roll + _HALF_TURN), roll)
    yaw = np.where(beyond, _wrap(yaw + _HALF_TURN), yaw)
    return np.stack(
        [
            np.clip(roll, -_QUARTER_TURN, _QUARTER_TURN),
            np.clip(pitch, -_QUARTER_TURN, _QUARTER_TURN),
            yaw,
        ],
        axis=-1,
    )


def _length(motion: NDArray[np.float64]) -> NDArray[np.float64]:
    with np.errstate(over="ignore", under="ignore"):
        return np.asarray(np.sqrt(motion[:, 0] ** 2 + motion[:, 1] ** 2 + motion[:, 2] ** 2))


def _clip_motion(motion: NDArray[np.float64]) -> NDArray[np.float64]:
    up = motion[:, 2:]
    motion = np.concatenate([motion[:, :2], np.where(up < 0.0, 0.0, up)], axis=-1)
    largest = np.abs(motion).max(axis=1, keepdims=True)
    vanished = largest < np.finfo(np.float64).tiny
    # Scaled by its largest number first, a huge or tiny motion neither overflows nor vanishes.
    scaled = motion / np.where(vanished, 1.0, largest)
    direction = scaled / np.where(vanished, 1.0, _length(scaled)[:, None])
    direction = np.where(vanished, (0.0, 0.0, 1.0), direction)
    length = _length(motion)[:, None]
    short, long = length < SHORTEST_MOTION, length > 1.0
    motion = np.where(short, direction * (SHORTEST_MOTION * (1.0 + _INWARDS)), motion)
    return np.where(long, direction * (1.0 - _INWARDS), motion)
