"""Statistics against values computed by hand or by counting."""

from itertools import combinations
from math import comb, erfc, isnan, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.tables.comparison import (
    Hypothesis,
    compare,
    effect_size,
    smallest_p,
    u_test,
)
from benchmarks.tables.holm import holm


def count_p(one, other):
    """Return the two-sided p value by dealing the values out in every way."""
    values, n = [*one, *other], len(one)

    def u(chosen):
        rest = [values[i] for i in range(len(values)) if i not in chosen]
        return sum((values[i] > b) + 0.5 * (values[i] == b) for i in chosen for b in rest)

    deals = [u(chosen) for chosen in combinations(range(len(values)), n)]
    seen = u(tuple(range(n)))
    above, below = sum(d >= seen for d in deals), sum(d <= seen for d in deals)
    return min(1.0, 2 * min(above, below) / len(deals))


def test_groups_that_do_not_overlap_have_the_smallest_p_there_is():
    assert u_test([6, 7, 8, 9, 10], [1, 2, 3, 4, 5]).p == pytest.approx(2 / 252)
    assert smallest_p(5) == pytest.approx(2 / 252)
    assert smallest_p(10) == pytest.approx(2 / comb(20, 10))
    assert smallest_p(1) == 1.0


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ([1, 4, 6, 9], [2, 3, 5]),
        ([85, 85, 84, 80], [85, 83, 80, 79]),
        ([1, 1, 1], [1, 1, 2]),
    ],
)
def test_p_is_that_of_all_deals_with_ties_and_without(one, other):
    test = u_test(one, other)

    assert test.p == pytest.approx(count_p(one, other))
    assert test.exact


def test_equal_values_are_no_difference():
    assert u_test([85] * 5, [85] * 5).p == 1.0


def test_many_values_are_approximated_and_say_so():
    one, other = np.arange(40.0), np.arange(40.0) + 20.5

    test = u_test([*one], [*other])

    assert not test.exact
    # Mean and deviation of U under the null, with the correction for continuity.
    wins = sum(int((value > other).sum()) for value in one)
    z = (abs(wins - 800) - 0.5) / sqrt(40 * 40 * 81 / 12)
    assert test.p == pytest.approx(erfc(z / sqrt(2)))


def test_the_effect_size_counts_wins_and_half_the_ties():
    effect = effect_size([3, 5, 5], [1, 5, 6], rng=np.random.default_rng(0))

    # 3 beats 1; each 5 beats 1 and ties with 5: 3 wins and 2 halves of 9.
    assert effect.a12 == pytest.approx(4 / 9)
    assert 0.0 <= effect.low < effect.a12 < effect.high <= 1.0


def test_the_same_seed_gives_the_same_interval():
    one, other = [4, 8, 2, 9, 7], [3, 5, 1, 8, 2]

    def interval(seed):
        effect = effect_size(one, other, rng=np.random.default_rng(seed))
        return effect.low, effect.high

    assert interval(1) == interval(1)


def test_a_single_value_has_no_interval():
    effect = effect_size([2], [1], rng=np.random.default_rng(0))

    assert effect.a12 == 1.0
    assert isnan(effect.low)
    assert isnan(effect.high)


def test_holm_gives_the_values_of_a_textbook():
    # R: p.adjust(c(0.01, 0.04, 0.03, 0.005), "holm")
    assert holm([0.01, 0.04, 0.03, 0.005]) == pytest.approx([0.03, 0.06, 0.06, 0.02])
    assert holm([0.6, 0.7]) == [1.0, 1.0]
    assert holm([]) == []


@given(st.lists(st.floats(0.0, 1.0), min_size=1, max_size=12))
@settings(max_examples=60, deadline=None)
def test_holm_keeps_the_order_and_lies_between_p_and_bonferroni(p_values):
    adjusted = np.array(holm(p_values))

    p = np.array(p_values)
    assert (adjusted >= p).all()
    assert (adjusted <= np.minimum(p * len(p), 1.0) + 1e-12).all()
    assert (np.diff(adjusted[np.argsort(p, kind="stable")]) >= 0.0).all()


FAMILY = tuple(Hypothesis("faucet", "m", "ours", other) for other in ("a", "b", "c"))


def by_method(values):
    return lambda _task, method, _measure: values.get(method)


def test_a_comparison_that_is_missing_counts_as_one():
    values = {"ours": [6, 7, 8, 9, 10], "a": [1, 2, 3, 4, 5]}

    (alone,) = compare(FAMILY, by_method(values))

    assert alone.hypothesis.other == "a"
    assert alone.adjusted == pytest.approx(3 * 2 / 252)


def test_an_interval_does_not_depend_on_which_others_are_there():
    values = {"ours": [6, 3, 8, 9, 1], "b": [1, 2, 3, 4, 5]}
    few = compare(FAMILY, by_method(values))
    values |= {"a": [5, 5, 5, 5, 4], "c": [1, 8, 9, 9, 9]}
    all_there = compare(FAMILY, by_method(values))

    assert few[0].effect == all_there[1].effect
    assert len(all_there) == 3
