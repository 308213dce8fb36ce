import dataclasses

import numpy as np
import pytest

from lqd_search import Refusal, Values, ValuesError


def columns(**changes):
    return {
        "valid": np.array([True, True, False]),
        "success": np.array([True, False, False]),
        "fitness": {"reach": np.array([1.0, np.nan, np.nan])},
        "measures": {"end.place": np.array([[1.0, 2.0], [np.nan, np.nan], [np.nan, np.nan]])},
    } | changes


def test_a_batch_has_a_length_and_columns_that_can_be_attached_later():
    values = Values(**columns())
    with_expert = dataclasses.replace(values, passive={"expert": np.array([True, False, False])})
    assert len(with_expert) == 3
    assert values.passive == {}
    assert with_expert.fitness is values.fitness


def test_a_batch_may_be_empty():
    none = np.zeros(0, bool)
    values = Values(
        valid=none,
        success=none,
        fitness={"reach": np.zeros(0)},
        measures={"end.place": np.zeros((0, 2))},
    )
    assert len(values) == 0


def test_rows_are_the_chosen_solutions_without_the_refusals_of_the_batch():
    refusal = Refusal("reach", "fitness", 1, "returned NaN", 1)
    passive, perceived = {"expert": np.arange(3)}, {"contact": np.arange(6.0).reshape(3, 2)}
    values = Values(**columns(refusals=(refusal,), passive=passive, perceived=perceived))
    some = values.rows(np.array([2, 0]))
    assert some.valid.tolist() == [False, True]
    assert some.success.tolist() == [False, True]
    np.testing.assert_equal(some.fitness, {"reach": np.array([np.nan, 1.0])})
    np.testing.assert_equal(some.measures, {"end.place": np.array([[np.nan] * 2, [1.0, 2.0]])})
    np.testing.assert_equal(some.passive, {"expert": np.array([2, 0])})
    np.testing.assert_equal(some.perceived, {"contact": np.array([[4.0, 5.0], [0.0, 1.0]])})
    assert some.refusals == ()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"valid": [True] * 3}, "valid to be a NumPy array, but it is a list; convert it"),
        ({"fitness": {"reach": [0.0] * 3}}, "fitness 'reach' to be a NumPy array, but it is a li"),
        ({"valid": np.ones((3, 1), bool)}, r"valid to have shape \(N,\)"),
        ({"valid": np.ones(3)}, "valid to have dtype bool, but it has float64"),
        ({"success": np.ones(2, bool)}, r"success to have shape \(N,\) with N = 3.*\(2,\)"),
        ({"success": np.zeros(3, int)}, "success to have dtype bool, but it has int64"),
        ({"success": np.array([True, False, True])}, "row 2 is successful and not valid"),
        ({"fitness": {"reach": np.zeros(4)}}, r"fitness 'reach' to have shape \(N,\)"),
        ({"fitness": {"reach": np.zeros(3, np.float32)}}, "fitness 'reach' to have dtype float64"),
        ({"fitness": {"reach": np.array([0, 1, np.inf])}}, "fitness 'reach' to be finite, or NaN"),
        ({"measures": {"end.place": np.zeros(3)}}, r"measures 'end.place' to have shape \(N, d\)"),
        ({"measures": {"end.place": np.zeros((3, 0))}}, "at least one column, but got none"),
        (
            {"measures": {"end.place": np.array([[0, 1], [0, np.nan], [0, 0]])}},
            r"row 1 is \[0.0, nan\]",
        ),
        (
            {"measures": {"end.place": np.array([[0, 1], [0, 1], [np.nan, 0]])}},
            r"row 2 is \[nan, 0.0\]",
        ),
        (
            {"measures": {"end.place": np.array([[0, np.inf], [0, 1], [0, 0]])}},
            r"row 0 is \[0.0, inf\]",
        ),
        ({"passive": {"expert": np.zeros(2)}}, r"passive column 'expert' .* \(2,\)"),
        ({"passive": {"expert": np.array(1.0)}}, r"passive column 'expert' .* \(\)"),
        ({"perceived": {"contact": np.zeros((2, 6))}}, r"perceived column 'contact' .* \(2, 6\)"),
        (
            {"passive": {"x": np.zeros(3)}, "perceived": {"x": np.zeros(3)}},
            "columns of different names, but both have 'x'; rename one",
        ),
    ],
)
def test_columns_that_do_not_fit_are_refused(changes, message):
    with pytest.raises(ValuesError, match=message):
        Values(**columns(**changes))
