"""Numbers of an instance's parts, checked and brought into one form."""

import math
from collections.abc import Sequence

from lqd_envs.instances.instance_error import InstanceError

Range = tuple[float, float]

HALF_ANGLES: Range = (1e-3, math.pi)
"""Half of how wide a cone or a sector may be, rad. In one of no width there is nothing."""


def checked_number(value: object, *, name: str, within: Range) -> float:
    """Return `value` as a plain float, never -0.0, so that equal parts are written equally.

    Args:
        value: What should be a number.
        name: What it is called in the error.
        within: Lowest and highest value allowed.

    Raises:
        InstanceError: It is no number, or lies outside.
    """
    low, high = within
    try:
        number = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError):
        number = math.nan
    if isinstance(value, bool | str | bytes) or not low <= number <= high:
        raise InstanceError(
            f"Expected {name} to be a number from {low:g} to {high:g}, but got {value!r}; choose "
            "one within that range."
        )
    return number + 0.0


def checked_numbers(values: object, *, name: str, length: int, within: Range) -> tuple[float, ...]:
    """Return `values` as a tuple of plain floats.

    Args:
        values: What should be a sequence of numbers.
        name: What it is called in the error.
        length: How many there must be.
        within: Lowest and highest value allowed for each of them.

    Raises:
        InstanceError: There are more or fewer of them, or one is no number or lies outside.
    """
    sized = isinstance(values, Sequence) and not isinstance(values, str | bytes)
    # A NumPy scalar has `tolist`, too, and no items.
    if not sized and not (hasattr(values, "tolist") and hasattr(values, "__len__")):
        raise InstanceError(
            f"Expected {name} to be {length} numbers, but got {values!r}; give a list of them."
        )
    items = list(values)  # type: ignore[call-overload]
    if len(items) != length:
        raise InstanceError(
            f"Expected {name} to be {length} numbers, but got {len(items)}; give each of them."
        )
    return tuple(checked_number(item, name=f"each number of {name}", within=within)
                 for item in items)  # fmt: skip


def checked_band(part: object, *, low: str, high: str, within: Range) -> Range:
    """Return the two attributes of `part` that are the ends of a band.

    Args:
        part: What has the attributes.
        low: Name of the attribute that is the lower end.
        high: Name of the one that is the upper end.
        within: Lowest and highest value allowed for both.

    Raises:
        InstanceError: One is no number or lies outside, or the lower end is not below the upper.
    """
    ends = tuple(
        checked_number(getattr(part, name), name=f"`{name}`", within=within) for name in (low, high)
    )
    if not ends[0] < ends[1]:
        raise InstanceError(
            f"Expected `{low}` below `{high}`, but got {ends[0]:g} and {ends[1]:g}; swap them or "
            "widen the band."
        )
    return ends[0], ends[1]
