"""Random successes, simulated again."""

import pytest

from benchmarks.robustness import Robustness, measure
from lqd_envs import get_task

TASK = get_task("LQD/Push-v0")


@pytest.fixture(scope="module")
def measured():
    return measure(TASK, successes=3, touching=5, most=1_000, seed=1)


def test_no_more_is_simulated_again_than_was_asked_for(measured):
    assert (measured.successes, measured.touching) == (3, 5)
    assert measured.solutions == 1_000


def test_most_successes_survive(measured):
    assert 2 <= measured.at_fine_step <= 3
    assert 2 <= measured.shifted <= 3
    assert 4 <= measured.agreeing <= 5


def test_what_is_not_found_is_counted_as_none():
    result = measure(TASK, successes=1, touching=0, most=8, seed=1)

    assert result == Robustness(
        solutions=8, successes=0, at_fine_step=0, shifted=0, toppled=0, touching=0, agreeing=0
    )
