"""How often the intervals of the reports hold the truth."""

import numpy as np
import pytest

from benchmarks.interval_coverage import effect_coverage, fixed_motion_coverage, rate_coverage


@pytest.mark.parametrize("spread", [(1.0, 0.0), (0.0, 1.0)])
def test_intervals_of_many_runs_and_instances_hold_the_truth_mostly(spread):
    rng = np.random.default_rng(0)

    assert rate_coverage(runs=20, spread=spread, repetitions=100, rng=rng) > 0.85


def test_a_single_run_s_interval_does_not_speak_for_other_runs():
    rng = np.random.default_rng(0)

    assert rate_coverage(runs=1, spread=(1.0, 0.0), repetitions=100, rng=rng) < 0.4


def test_the_interval_of_a_fixed_motion_chosen_on_halves_holds_the_truth_mostly():
    share = fixed_motion_coverage(runs=5, repetitions=60, rng=np.random.default_rng(0))

    assert 0.6 < share < 0.98


def test_the_interval_of_a_large_effect_with_few_seeds_is_too_narrow():
    rng = np.random.default_rng(0)
    few, many = (
        effect_coverage(seeds=seeds, a12=0.92, repetitions=40, rng=rng) for seeds in (4, 30)
    )

    assert few < 0.8 < many
