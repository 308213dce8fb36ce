"""The figures of an archive in an instance."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.instances.figures import (
    BEST_IN_HINDSIGHT,
    BEST_ON_THE_OTHER_HALF,
    HIGHEST_FITNESS,
    FixedMotion,
    SomeMotion,
    Success,
    by_size,
    fixed_motions,
    values_of,
    whole_archive,
)
from benchmarks.instances.judged_run import InstancesError
from benchmarks.instances.judgement import FilterFigures
from benchmarks.instances.looked_at import LookedAt

FIGURES = FilterFigures(
    motions=100,
    judged=50,
    solved=10,
    first={"best": 3, "diverse": 0},
    subsets={"best": {"1": (4, 4, 4), "2": (5, 6, 6)}, "diverse": {"1": (4, 4, 4)}},
    looked_at=LookedAt.of(np.arange(60), np.arange(100) < 12, evaluation=np.arange(100)),
)


@pytest.mark.parametrize(
    ("figure", "expected"),
    [
        (SomeMotion(), 1.0),
        (SomeMotion(1), 0.2),
        (SomeMotion(2), 1 - 40 * 39 / (50 * 49)),
        (HIGHEST_FITNESS, 0.0),
        (Success("best", 5), 1.0),
        (Success("diverse", 20), 0.0),
        (Success("random", 1), 0.2),
        (Success("best", 1, 2), 0.25),
        (Success("best", 20, 2), 0.3),
        (Success("best", 5, 100), 1.0),
    ],
)
def test_figures_by_hand(figure, expected):
    assert figure.of(FIGURES) == pytest.approx(expected)


def test_what_only_a_selector_found_counts_as_some_motion():
    chosen = LookedAt.of(np.arange(60), np.arange(100) == 55, evaluation=np.arange(100))
    figures = replace(FIGURES, solved=0, first={"best": 4, "diverse": 0}, looked_at=chosen)

    assert SomeMotion().of(figures) == Success("best", 5).of(figures) == 1.0
    # A random subset is one of those that were drawn.
    assert SomeMotion(50).of(figures) == 0.0


def test_a_size_that_was_not_counted_is_not_answered_by_the_whole_archive():
    with pytest.raises(InstancesError, match="subsets of 7 motions, but the judgement does not"):
        Success("best", 1, 7).of(FIGURES)


def test_a_single_instance_has_no_halves():
    assert fixed_motions(instances=1) == [BEST_IN_HINDSIGHT]
    assert fixed_motions(instances=2) == [BEST_IN_HINDSIGHT, BEST_ON_THE_OTHER_HALF]


def test_a_fixed_motion_s_figures_by_hand():
    solves = np.array([[1, 0, 0], [1, 1, 0], [1, 0, 1], [0, 1, 0]], dtype=bool)
    numbers = np.arange(3)
    row = [
        replace(FIGURES, looked_at=LookedAt.of(numbers, solved, evaluation=numbers))
        for solved in solves
    ]

    assert FixedMotion("hindsight").of(row) == [1.0, 1.0, 1.0, 0.0]
    assert values_of(BEST_IN_HINDSIGHT, row) == [1.0, 1.0, 1.0, 0.0]
    assert values_of(SomeMotion(1), row) == pytest.approx([0.2] * 4)


def test_figures_by_size_reach_up_to_what_was_judged_and_drawn():
    sizes = {type(f): [] for f in (SomeMotion(), HIGHEST_FITNESS)}
    for figure in by_size(judged=60, cap=20):
        sizes[type(figure)].append(figure.size)

    assert sizes[SomeMotion] == [1, 2, 5, 10, 20, 50]
    assert set(sizes[Success]) == {1, 2, 5, 10}
    assert HIGHEST_FITNESS in whole_archive()
