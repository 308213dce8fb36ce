"""How finely the parameters of drawn instances are written."""

DECIMALS = 4


def rounded(value: float) -> float:
    """Return a drawn number to four decimals: a tenth of a millimetre, or of a milliradian.

    So that instances are short to write, and their names do not hang on a last bit.
    """
    return round(float(value), DECIMALS)
