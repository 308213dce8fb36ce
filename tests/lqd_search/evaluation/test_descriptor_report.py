import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from lqd_search.evaluation.descriptor_report import DescriptorReport, report_descriptors

RNG = np.random.default_rng(0)
PLACE = RNG.random((40, 3))
PLACE[[3, 17]] = np.nan
OTHER = RNG.random((40, 3))
OTHER[[3, 17]] = np.nan


def same(**measures):
    return report_descriptors(measures).same


@pytest.mark.parametrize(
    "twin",
    [
        PLACE.copy(),
        PLACE * 100.0,
        PLACE - 3.0,
        PLACE * [-2.0, 1.0, 0.1] + [0.0, 1e3, -1.0],
        PLACE[:, [2, 0, 1]],
        5.0 - PLACE[:, ::-1],
    ],
)
def test_order_scale_sign_and_offset_make_no_difference(twin):
    assert same(one=PLACE, other=OTHER, two=twin) == (("one", "two"),)


@pytest.mark.parametrize(
    "another",
    [
        OTHER,
        PLACE**2,
        PLACE[:, :2],
        PLACE + 1e-6 * OTHER,
        PLACE[:, [0, 0, 1]],
        np.where(np.arange(40)[:, None] == 5, np.nan, PLACE),
        np.column_stack([PLACE[:, :2], np.where(np.isnan(PLACE[:, 2]), np.nan, 1.0)]),
    ],
)
def test_other_values_columns_or_rows_make_one(another):
    assert same(one=PLACE, two=another) == ()


def test_groups_and_their_members_are_in_the_descriptors_order():
    measures = {"a": PLACE, "b": OTHER, "c": -PLACE, "d": OTHER * 2.0, "e": PLACE + 1.0}
    assert same(**measures) == (("a", "c", "e"), ("b", "d"))


def test_a_measure_that_does_not_vary_is_like_another_one():
    flat = np.column_stack([PLACE[:, 0], np.where(np.isnan(PLACE[:, 0]), np.nan, 7.0)])
    assert same(one=flat, two=flat + 1.0, three=PLACE[:, :2]) == (("one", "two"),)


def test_degenerate_and_undefined_descriptors_are_neither_the_same():
    constant = np.where(np.isnan(PLACE[:, :2]), np.nan, [1.0, 2.0])
    nothing = np.full((40, 2), np.nan)
    report = report_descriptors(
        {"c1": constant, "u1": nothing, "p": PLACE, "c2": constant, "u2": nothing}
    )
    assert report == DescriptorReport(same=(), degenerate=("c1", "c2"), undefined=("u1", "u2"))


def test_one_defined_row_is_degenerate():
    once = np.full((40, 2), np.nan)
    once[4] = [0.1, 0.2]
    assert report_descriptors({"once": once}).degenerate == ("once",)


def test_without_motions_all_are_undefined():
    report = report_descriptors({"a": np.empty((0, 2)), "b": np.empty((0, 1))})
    assert report == DescriptorReport(same=(), degenerate=(), undefined=("a", "b"))


def test_the_largest_and_the_smallest_numbers_are_compared():
    huge = np.array([[-1e308], [1e308], [0.0]])
    tiny = np.array([[0.0], [5e-324], [0.0]])
    report = report_descriptors({"huge": huge, "scaled": huge * 1e-300, "tiny": tiny})
    assert report.same == (("huge", "scaled"),)


@given(
    hnp.arrays(
        np.float64,
        st.tuples(st.integers(2, 8), st.integers(1, 3)),
        elements=st.integers(-4, 4).map(float),
    ),
    st.data(),
)
def test_whatever_is_turned_around_says_the_same(block, data):
    assume(np.ptp(block, axis=0).any())
    d = block.shape[1]
    order = data.draw(st.permutations(range(d)))
    scale = data.draw(
        st.lists(st.sampled_from([-8.0, -0.3, 0.01, 1.0, 7.0]), min_size=d, max_size=d)
    )
    offset = data.draw(st.lists(st.floats(-9.0, 9.0), min_size=d, max_size=d))
    hole = data.draw(st.lists(st.integers(0, len(block) - 1), max_size=2))
    twin = block[:, order] * scale + offset
    block[hole], twin[hole] = np.nan, np.nan
    report = report_descriptors({"one": block, "two": twin})
    if report.degenerate or report.undefined:
        assert set(report.degenerate + report.undefined) == {"one", "two"}
    else:
        assert report.same == (("one", "two"),)


def test_a_sentence_for_each():
    report = DescriptorReport(
        same=(("a.b", "c.d"), ("e", "f", "g")), degenerate=("h", "j"), undefined=("i",)
    )
    assert report.sentences() == (
        "The same on the first batch, up to order, scale and offset: a.b, c.d.",
        "The same on the first batch, up to order, scale and offset: e, f, g.",
        "With a single value on the first batch, so that they tell no motions apart: h, j.",
        "Defined for no motion of the first batch: i.",
    )
    assert report_descriptors({"a": PLACE}).sentences() == ()
