"""The shape of one descriptor's grid, and how it is learned from values."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lqd_envs.errors import LQDError

_PADDING = 0.05
_LARGEST = 1e100


class GridSpecError(LQDError):
    """A grid's dimensions or ranges make no sense."""


@dataclass(frozen=True)
class GridSpec:
    """How many cells a grid has along each dimension, and over which range.

    Attributes:
        dims: Number of cells along each dimension.
        ranges: Lower and upper bound of each dimension, in the units of its measure.

    Raises:
        GridSpecError: Their lengths differ or are 0, a number of cells is below 1, or a range is
            empty or infinite.
    """

    dims: tuple[int, ...]
    ranges: tuple[tuple[float, float], ...]

    def __post_init__(self) -> None:
        if not self.dims or len(self.dims) != len(self.ranges):
            raise GridSpecError(
                "Expected one number of cells and one range for each dimension, but got "
                f"{len(self.dims)} numbers of cells and {len(self.ranges)} ranges; give as many "
                "of both."
            )
        if min(self.dims) < 1:
            raise GridSpecError(
                f"Expected at least 1 cell per dimension, but got {self.dims}; raise what is lower."
            )
        for lower, upper in self.ranges:
            if not (math.isfinite(upper - lower) and lower < upper):
                raise GridSpecError(
                    f"Expected a finite lower bound below a finite upper one, but got "
                    f"({lower}, {upper}); choose others."
                )

    @property
    def cells(self) -> int:
        """Number of cells of the grid."""
        return math.prod(self.dims)

    def out_of_range(self, values: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Say which rows have a measure out of range; these fall into cells at the edge.

        Args:
            values: (n, d) float64, defined measures.

        Returns:
            (n,) bool.
        """
        lower, upper = np.array(self.ranges).T
        outside: NDArray[np.bool_] = ((values < lower) | (values > upper)).any(axis=1)
        return outside

    def to_dict(self) -> dict[str, Any]:
        """Return the spec as lists and numbers, fit for JSON."""
        return {"dims": list(self.dims), "ranges": [list(bounds) for bounds in self.ranges]}

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> "GridSpec":
        """Make the spec that `to_dict` wrote.

        Args:
            data: `{"dims": [...], "ranges": [[lower, upper], ...]}`, of lists or arrays.

        Returns:
            The spec.

        Raises:
            GridSpecError: A key is missing, or the content makes no sense.
        """
        if not {"dims", "ranges"} <= set(data):
            raise GridSpecError(
                f"Expected a grid spec with the keys 'dims' and 'ranges', but got {sorted(data)}; "
                "pass what to_dict returned."
            )
        return cls(
            dims=tuple(int(cells) for cells in data["dims"]),
            ranges=tuple((float(lower), float(upper)) for lower, upper in data["ranges"]),
        )


def learn_grid_spec(values: NDArray[np.float64], *, cells: int = 10_000) -> GridSpec:
    """Learn a descriptor's grid from the values that it took.

    A dimension reaches over the values seen, padded by 5 % of their span a side. One that took
    only the values 0 and 1, and both, gets 2 cells; one that took a single value gets 1 cell. The
    others share the cells evenly.

    Args:
        values: (n, d) float64, defined measures, with n at least 1.
        cells: About as many cells the grid will have.

    Returns:
        The spec.

    Raises:
        GridSpecError: There is no value, or one is NaN or infinite.
    """
    if values.ndim != 2 or values.size == 0 or not np.isfinite(values).all():
        raise GridSpecError(
            "Expected finite values of shape (n, d), with n and d at least 1, to learn a grid "
            f"from, but got shape {values.shape}; leave undefined rows out."
        )
    # Without this bound the span of two finite values could be infinite.
    columns = np.clip(values, -_LARGEST, _LARGEST).T
    binary = [set(np.unique(column)) == {0.0, 1.0} for column in columns]
    constant = [column.min() == column.max() for column in columns]
    continuous = len(columns) - sum(binary) - sum(constant)
    shared = max(1, round((cells / 2 ** sum(binary)) ** (1 / max(continuous, 1))))
    dims = tuple(
        2 if is_binary else 1 if is_constant else shared
        for is_binary, is_constant in zip(binary, constant, strict=True)
    )
    return GridSpec(dims=dims, ranges=tuple(_range_of(column) for column in columns))


def _range_of(column: NDArray[np.float64]) -> tuple[float, float]:
    lower, upper = float(column.min()), float(column.max())
    if lower == upper:
        # Half a unit vanishes beside a huge value.
        half = max(0.5, abs(lower) * 1e-6)
        return lower - half, upper + half
    if np.isin(column, (0.0, 1.0)).all():
        return -0.5, 1.5
    padding = _PADDING * (upper - lower)
    return lower - padding, upper + padding
