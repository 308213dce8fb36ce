"""What the pictures by size show."""

from dataclasses import dataclass

import numpy as np
import pytest

from benchmarks.instances.figures import BEST_IN_HINDSIGHT, SomeMotion, Success
from benchmarks.instances.size_picture import draw_sizes
from benchmarks.instances.two_way import Rate
from lqd_search.adaptation import SELECTORS

FAUCET = "LQD/Faucet-v0"


@dataclass(frozen=True)
class LookedAt:
    motions: int


@dataclass(frozen=True)
class Figures:
    motions: int
    looked_at: LookedAt


def rate(value):
    return Rate(value, value - 0.125, value + 0.125)


@dataclass(frozen=True)
class FakeResults:
    """Of one method whose runs have 30, 40 and 400 motions, of which at most 24 were looked at."""

    kinds = ("change",)

    def methods(self, task):
        assert task == FAUCET
        return ["handcrafted"]

    def figures(self, task, kind, method, by):
        assert (task, kind, method, by) == (FAUCET, "change", "handcrafted", "inferred")
        return [[Figures(n, LookedAt(min(n, 24)))] for n in (30, 40, 400)]

    def rates(self, *_):
        return {
            SomeMotion(): rate(0.875),
            BEST_IN_HINDSIGHT: rate(0.5),
            **{SomeMotion(size): rate(size / 64) for size in (50, 2, 10)},
            **{Success(name, 5): rate(0.75) for name in SELECTORS},
            **{Success(name, 5, size): rate(size / 128) for name in SELECTORS for size in (2, 10)},
        }


@pytest.fixture(scope="module")
def panels():
    return draw_sizes(FakeResults(), FAUCET).axes


def test_a_line_goes_by_size_up_to_the_whole_archive(panels):
    above, below = panels
    [line] = above.get_lines()
    # What was looked at bounds what some motion solves; a selector chooses from all.
    assert line.get_xydata().tolist() == [[2, 2 / 64], [10, 10 / 64], [24, 0.875]]
    assert line.get_label() == "handcrafted (expert)"
    for line in below.get_lines():
        assert line.get_xydata().tolist() == [[2, 2 / 128], [10, 10 / 128], [40, 0.75]]


def test_selectors_are_told_apart(panels):
    lines = panels[1].get_lines()

    assert [line.get_label() for line in lines] == [f"handcrafted (expert), {s}" for s in SELECTORS]
    assert len({line.get_linestyle() for line in lines}) == len(SELECTORS)


def test_bands_are_the_intervals(panels):
    [band] = panels[0].collections
    corners = band.get_paths()[0].vertices

    for size, value in ((2, 2 / 64), (24, 0.875)):
        heights = corners[np.isclose(corners[:, 0], size)][:, 1]
        assert (heights.min(), heights.max()) == pytest.approx((value - 0.125, value + 0.125))
