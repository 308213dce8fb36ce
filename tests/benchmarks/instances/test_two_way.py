"""Means over runs and instances, with intervals."""

import math

import numpy as np
import pytest

from benchmarks.instances.two_way import Rate, mean_over_groups, two_way


def rates(values, seed=0):
    return two_way(np.asarray(values, float), rng=np.random.default_rng(seed))


def test_the_mean_is_that_of_all_pairs():
    (one, other) = rates([[[1.0, 0.0], [0.0, 0.0]], [[1.0, 0.5], [1.0, 0.5]]])

    assert one.value == 0.75
    assert other.value == 0.25


def test_what_does_not_vary_has_no_width():
    (rate,) = rates(np.ones((4, 6, 1)))

    assert (rate.value, rate.low, rate.high) == (1.0, 1.0, 1.0)


def test_one_run_resamples_instances_as_a_binomial():
    # The mean of 40 coins: its bootstrap interval is that of a binomial of 40 and 1/2.
    (rate,) = rates((np.arange(40) % 2)[None, :, None])

    assert rate.value == 0.5
    assert rate.low == pytest.approx(0.35, abs=0.026)
    assert rate.high == pytest.approx(0.65, abs=0.026)


def test_runs_and_instances_both_widen_it():
    rng = np.random.default_rng(1)
    by_run, by_instance = rng.random((12, 1)), rng.random((1, 12))
    both = by_run + by_instance

    widths = [
        rate.high - rate.low
        for values in (by_run, by_instance, both)
        for rate in rates(np.broadcast_to(values / 2, (12, 12))[:, :, None])
    ]

    assert widths[2] > max(widths[:2])
    assert widths[2] == pytest.approx(math.hypot(*widths[:2]), rel=0.15)


def test_a_single_pair_has_no_interval():
    (rate,) = rates([[[0.25]]])

    assert rate.text == "25%"
    assert math.isnan(rate.low)
    assert math.isnan(rate.high)


def test_the_same_seed_gives_the_same_bits():
    values = np.random.default_rng(3).random((5, 7, 2))

    assert rates(values, seed=8) == rates(values, seed=8)


def test_each_task_and_kind_counts_alike_in_the_mean():
    values = np.zeros((5, 4))
    groups = [[values + 1.0, values], [values[:2, :3] + 1.0]]

    rate = mean_over_groups(groups, rng=np.random.default_rng(0))

    assert (rate.value, rate.low, rate.high) == pytest.approx((2 / 3, 2 / 3, 2 / 3))


def test_runs_are_drawn_together_for_all_kinds_of_a_task_and_apart_for_tasks():
    by_run = np.broadcast_to(np.random.default_rng(2).random((30, 1)), (30, 6))

    together, apart = (
        mean_over_groups(groups, rng=np.random.default_rng(0))
        for groups in ([[by_run, by_run]], [[by_run], [by_run]])
    )

    assert together.value == apart.value
    width = (together.high - together.low) / (apart.high - apart.low)
    assert width == pytest.approx(2**0.5, rel=0.1)


def test_a_single_pair_among_the_groups_leaves_no_interval():
    groups = [[np.ones((1, 4)), np.zeros((1, 1))]]

    rate = mean_over_groups(groups, rng=np.random.default_rng(0))

    assert rate.text == "50%"


@pytest.mark.parametrize(
    ("rate", "text"),
    [(Rate(0.998, 0.996, 1.0), "> 99% [> 99, 100]"), (Rate(0.002, 0.0, 0.004), "< 1% [0, < 1]")],
)
def test_an_interval_does_not_seem_to_leave_its_own_rate_out(rate, text):
    assert rate.text == text


def test_a_rate_reads_as_percent():
    assert Rate(0.534, 0.409, 0.641).text == "53% [41, 64]"
