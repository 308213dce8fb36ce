"""Variances against values computed by hand, and intervals against what they promise."""

import numpy as np
import pytest

from benchmarks.tables.variance import split_variance


def split(table, seed=0):
    return split_variance(np.array(table, float), rng=np.random.default_rng(seed))


def test_the_components_are_those_of_the_analysis_of_variance():
    # Rows 2, 5, 8 on average and columns 4, 6; what is left is 1, -1, 0, 0, -1, 1.
    variances = split([[2, 2], [4, 6], [6, 10]])

    # Mean squares: rows 2 * 18 / 2 = 18, columns 3 * 2 / 1 = 6, rest 4 / 2 = 2.
    assert variances.rows.variance == pytest.approx((18 - 2) / 2)
    assert variances.columns.variance == pytest.approx((6 - 2) / 3)
    assert variances.rest.variance == pytest.approx(2)
    total = 8 + 4 / 3 + 2
    assert variances.rows.share == pytest.approx(8 / total)
    assert variances.columns.share == pytest.approx(4 / 3 / total)
    assert variances.rest.share == pytest.approx(2 / total)

    assert variances.but_rows.variance == pytest.approx(4 / 3 + 2)
    assert variances.but_rows.share == pytest.approx((4 / 3 + 2) / total)
    assert variances.but_rows.low == pytest.approx(1 - variances.rows.high)
    assert variances.but_rows.high == pytest.approx(1 - variances.rows.low)


def test_a_negative_estimate_is_nothing():
    variances = split([[0, 1], [1, 0]])

    assert (variances.rows.variance, variances.columns.variance) == (0.0, 0.0)
    assert variances.rest.share == 1.0


def test_what_only_rows_make_differ_is_theirs():
    variances = split([[1, 1, 1], [5, 5, 5], [9, 9, 9]])

    assert variances.rows.share == pytest.approx(1.0)
    assert (variances.rows.low, variances.rows.high) == pytest.approx((1.0, 1.0))


def test_where_nothing_varies_there_is_no_share():
    variances = split([[85, 85], [85, 85]])

    assert np.isnan([variances.rows.share, variances.columns.low, variances.rest.high]).all()


def test_the_same_seed_gives_the_same_interval():
    table = [[3, 1, 4], [1, 5, 9], [2, 6, 5], [3, 5, 8]]

    assert split(table, seed=3) == split(table, seed=3)
    assert split(table, seed=3) != split(table, seed=4)


@pytest.mark.parametrize("share", [0.2, 0.6, 0.9])
def test_an_interval_holds_the_share_as_often_as_it_says(share):
    rng = np.random.default_rng(5)
    rows, columns = 5, 3
    held = 0
    for _ in range(200):
        table = np.sqrt(share) * rng.normal(size=(rows, 1)) + np.sqrt(1 - share) * rng.normal(
            size=(rows, columns)
        )
        of_rows = split_variance(table, rng=rng).rows
        held += of_rows.low <= share <= of_rows.high
    # 95 % of 200, less four standard deviations.
    assert held >= 178
