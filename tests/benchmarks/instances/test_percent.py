"""Shares as they stand in tables."""

import pytest

from benchmarks.instances.percent import percent


@pytest.mark.parametrize(
    ("share", "expected"),
    [
        (0.0, "0%"),
        (0.0025, "< 1%"),
        (0.005, "< 1%"),
        (0.0051, "1%"),
        (0.534, "53%"),
        (0.9949, "99%"),
        (0.995, "> 99%"),
        (0.9999, "> 99%"),
        (1.0, "100%"),
    ],
)
def test_what_is_rounded_to_all_or_nothing_is_not_called_so(share, expected):
    assert percent(share) == expected
