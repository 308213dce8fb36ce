import math

import pytest

from benchmarks.tables.spread import Spread


def test_the_figures_are_those_computed_by_hand():
    spread = Spread.of([2.0, 4.0, 9.0, math.nan])

    assert (spread.n, spread.mean, spread.median) == (3, 5.0, 4.0)
    assert spread.std == pytest.approx(math.sqrt((9 + 1 + 16) / 2))
    assert (spread.low, spread.high) == (3.0, 6.5)
    assert spread.mean_text() == "5.0 ± 3.6"
    assert spread.median_text(2) == "4.00 [3.00, 6.50]"


def test_a_single_value_has_no_deviation():
    assert Spread.of([1234.0]).mean_text() == "1,234.0"


def test_where_nothing_is_defined_there_is_no_spread():
    assert Spread.of([math.nan]) is None
