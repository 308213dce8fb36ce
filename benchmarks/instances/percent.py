"""A share as it stands in a table."""

_NEARLY_ALL = 0.995
_NEARLY_NOTHING = 0.005


def percent(share: float) -> str:
    """Return a share in percent: what would be rounded to all or to nothing is not called so.

    Args:
        share: From 0 to 1.
    """
    if _NEARLY_ALL <= share < 1.0:
        return "> 99%"
    # Python rounds halves to even, so that 0.5 % would be nothing.
    return "< 1%" if 0.0 < share <= _NEARLY_NOTHING else f"{share:.0%}"
