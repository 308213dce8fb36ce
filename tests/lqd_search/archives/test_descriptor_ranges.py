import numpy as np
import pytest

from lqd_search import DescriptorRanges, ObservationError, ObservationLog

DESCRIPTORS = {"a": 1, "b": 2}


def seen(a, b=()):
    """Measures of as many solutions as `a` has values; `b` is defined for the first ones."""
    block = np.full((len(a), 2), np.nan)
    block[: len(b)] = np.array(b, float).reshape(-1, 2)
    return {"a": np.array(a, float)[:, None], "b": block}


RANGES = DescriptorRanges(DESCRIPTORS, minimum=4, cells=100)


def test_at_first_every_descriptor_waits():
    assert RANGES.waiting == ("a", "b")
    assert RANGES.specs == {}


def test_a_range_is_learned_once_there_are_enough_defined_values():
    early = RANGES.observe(seen([0, 1, 2], [(0, 0)]))
    assert early.waiting == ("a", "b")
    later = early.observe(seen([10, np.nan], [(1, 1)]))
    assert later.waiting == ("b",)
    assert later.specs["a"].dims == (100,)
    assert later.specs["a"].ranges[0] == pytest.approx((-0.5, 10.5))
    assert RANGES.waiting == ("a", "b")  # it does not change


def test_undefined_values_do_not_count():
    ranges = RANGES.observe(seen([0, np.nan, 2, 3], [(0, 0), (1, 1), (2, 2)]))
    assert ranges.waiting == ("a", "b")


def test_a_range_once_known_stays():
    ranges = RANGES.observe(seen([0, 1, 2, 3]))
    assert ranges.observe(seen([99] * 8)).specs["a"] == ranges.specs["a"]


def test_exactly_as_many_as_needed_are_enough():
    sixty_four = DescriptorRanges(DESCRIPTORS)
    assert sixty_four.observe(seen(range(63))).waiting == ("a", "b")
    assert sixty_four.observe(seen(range(64))).waiting == ("b",)
    assert sixty_four.observe(seen(range(64))).specs["a"].cells == 10_000


def test_ranges_are_learned_again_from_the_log():
    ranges = RANGES.observe(seen([0, 1, 2, 3], [(0, 0)]))
    log = ObservationLog(DESCRIPTORS)
    log.record(np.arange(4), seen([0, 1, 2, 3], [(0, 0)]))
    log.record(np.array([7, 9]), seen([20, np.nan], [(1, 1), (2, 2)]))
    again = ranges.relearn(log)
    assert again.specs["a"].ranges[0] == pytest.approx((-1.0, 21.0))
    assert again.waiting == ("b",)
    # It goes on waiting, with what is in the log as seen.
    learned = again.observe(seen([0], [(4, 4)]))
    assert learned.specs["b"].ranges[0] == pytest.approx((-0.2, 4.2))
    assert learned.specs["a"] == again.specs["a"]


def test_the_log_finds_measures_by_evaluation():
    log = ObservationLog(DESCRIPTORS)
    log.record(np.array([1, 3]), seen([10, 30], [(1, 1)]))
    log.record(np.array([4, 8]), seen([40, 80], [(4, 4), (8, 8)]))
    found = log.measures(np.array([8, 3]))
    assert found["a"].tolist() == [[80.0], [30.0]]
    assert found["b"][0].tolist() == [8.0, 8.0]
    assert np.isnan(found["b"][1]).all()
    assert log.defined("b").tolist() == [[1, 1], [4, 4], [8, 8]]
    assert len(log) == 4
    assert log.measures(np.array([], int))["b"].shape == (0, 2)


def test_the_log_refuses_what_it_cannot_place():
    log = ObservationLog(DESCRIPTORS)
    log.record(np.array([1, 3]), seen([10, 30]))
    with pytest.raises(ObservationError, match=r"ascend from 4, but got \[3, 4\] first"):
        log.record(np.array([3, 4]), seen([10, 30]))
    with pytest.raises(ObservationError, match=r"ascend from 4, but got \[5, 5\] first"):
        log.record(np.array([5, 5]), seen([10, 30]))
    with pytest.raises(ObservationError, match="but 2 is none of the 2 in the log; record"):
        log.measures(np.array([1, 2]))
    with pytest.raises(ObservationError, match="but 9 is none of the 2 in the log"):
        log.measures(np.array([9]))


def test_a_missing_descriptor_is_named():
    with pytest.raises(ObservationError, match="but b are missing; got a"):
        RANGES.observe({"a": np.zeros((1, 1))})
    with pytest.raises(ObservationError, match="but a, b are missing; got none"):
        ObservationLog(DESCRIPTORS).record(np.array([0]), {})
