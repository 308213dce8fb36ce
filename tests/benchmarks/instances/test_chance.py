"""The probability that a random subset has a member of some kind."""

from itertools import combinations
from math import comb

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchmarks.instances.chance import chance


@pytest.mark.parametrize(
    ("n", "solving", "size", "expected"),
    [
        (10, 3, 1, 0.3),
        (4, 2, 2, 5 / 6),
        (5, 1, 5, 1.0),
        (5, 0, 3, 0.0),
        (5, 2, 0, 0.0),
        (5, 1, 50, 1.0),
        (5, 0, 50, 0.0),
        (0, 0, 3, 0.0),
        (5, 3, 3, 1.0),
    ],
)
def test_small_ones_by_hand(n, solving, size, expected):
    assert float(chance(n, solving, size)) == pytest.approx(expected, abs=1e-14)


@given(n=st.integers(1, 9), data=st.data())
def test_it_is_the_share_of_all_subsets(n, data):
    solving, size = data.draw(st.integers(0, n)), data.draw(st.integers(1, n))

    hits = [min(subset) < solving for subset in combinations(range(n), size)]

    assert float(chance(n, solving, size)) == pytest.approx(np.mean(hits), abs=1e-12)


def test_large_archives_lose_no_digits():
    exact = 1 - comb(20_000 - 3, 500) / comb(20_000, 500)

    assert float(chance(20_000, 3, 500)) == pytest.approx(exact, rel=1e-9)


def test_arrays_broadcast():
    assert chance(10, np.array([0, 5, 10]), 1).tolist() == pytest.approx([0.0, 0.5, 1.0])
