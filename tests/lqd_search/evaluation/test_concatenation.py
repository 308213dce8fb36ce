import dataclasses

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lqd_search import Values, ValuesError
from lqd_search.evaluation.concatenation import concatenate_values
from lqd_search.evaluation.functional_calls import RefusedValueError
from lqd_search.evaluation.refusals import Refusals


def judge(solutions):
    """Judge whole numbers, one a motion; their last digits say what is refused."""
    refusals = Refusals()
    for i, number in enumerate(solutions):
        if number % 2:
            refusals.note(i, "success", "success", RefusedValueError("is odd"))
        if number % 3:
            refusals.note(i, "fitness", "reach", RefusedValueError(f"leaves {number % 3}"))
            refusals.note(i, "quantity", "reach", RefusedValueError(f"leaves {number % 3}"))
    valid = solutions % 7 != 0
    fitness = np.where(valid, solutions / 3.0, np.nan)
    return Values(
        valid=valid,
        success=valid & (solutions % 2 == 0),
        fitness={"reach": fitness, "away": -fitness},
        measures={"end.place": np.stack([fitness, fitness], axis=1)},
        refusals=refusals.listed(),
        passive={"digest": solutions.astype(np.uint64), "word": np.full(len(solutions), "a")},
        perceived={"contact": np.stack([fitness] * 3, axis=1).astype(np.float32)},
    )


def bits(values):
    columns = {}
    for field in dataclasses.fields(Values):
        column = getattr(values, field.name)
        for name, array in (column if isinstance(column, dict) else {"": column}).items():
            if field.name not in ("refusals", "stopped"):
                columns[field.name, name] = (array.dtype, array.shape, array.tobytes())
    return list(columns.items()), values.refusals, values.stopped


@given(st.lists(st.integers(0, 40), max_size=12), st.lists(st.integers(0, 12), max_size=4))
def test_chunks_give_the_bits_of_the_whole_batch(numbers, cuts):
    solutions = np.array(numbers, dtype=np.int64)
    parts = [judge(chunk) for chunk in np.split(solutions, sorted(cuts))]
    assert bits(concatenate_values(parts)) == bits(judge(solutions))


def test_refusals_are_counted_over_the_chunks_and_point_into_the_batch():
    odd, _, _ = judge(np.array([7])).refusals
    joined = concatenate_values([judge(np.array(n)) for n in ([6, 6], [6, 9], [3, 6, 9])])
    assert joined.refusals == (dataclasses.replace(odd, count=3, first_motion=3),)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"fitness": {}}, r"same fitness columns .* chunk 0 has 'reach' .* chunk 1 has none"),
        ({"passive": {"digest": np.zeros(2)}}, r"passive .*'digest' \(uint64.*float64"),
        ({"perceived": {"contact": np.zeros((2, 2), np.float32)}}, r"shape \(3,\).*shape \(2,\)"),
        ({"measures": {"start.place": np.zeros((2, 2))}}, "'end.place'.*'start.place'"),
    ],
)
def test_chunks_with_other_columns_are_refused(changes, message):
    part = judge(np.array([2, 4]))
    with pytest.raises(ValuesError, match=message):
        concatenate_values([part, dataclasses.replace(part, **changes)])


def test_there_must_be_a_chunk():
    with pytest.raises(ValuesError, match="at least one chunk"):
        concatenate_values([])
