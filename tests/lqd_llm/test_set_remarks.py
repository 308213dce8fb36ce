import numpy as np
import pytest

from lqd_llm import Candidate, CheckOutcome, FunctionSource, remarks

NOTHING = [np.nan, np.nan]


def checked(entry, values, *, name="it", kind="some"):
    source = FunctionSource(name=name, description="", code="")
    return Candidate(source, kind, entry), CheckOutcome(values=np.array(values, float))


def column(*numbers):
    return [[number] for number in numbers]


@pytest.mark.parametrize(
    ("entry", "values", "sentence"),
    [
        (
            "fitness",
            column(2.0, 2.0, 2.0),
            "The fitness 'it' gives the same number for all 3 example motions.",
        ),
        (
            "timestamp",
            column(-1, -1),
            "The timestamp 'it' is defined on none of the 2 example motions.",
        ),
        (
            "quantity",
            np.ones((2, 3, 5)),
            "The quantity 'it' gives the same numbers at the first, the middle and the last moment "
            "of all 2 example motions.",
        ),
    ],
)
def test_function_that_adds_little(entry, values, sentence):
    assert remarks([checked(entry, values)]) == (sentence,)


@pytest.mark.parametrize(
    ("entry", "values"),
    [
        ("fitness", column(2.0, 2.0, 2.5)),
        ("timestamp", column(-1, 0)),
        ("timestamp", column(7, 7)),
        ("quantity", np.arange(30.0).reshape(2, 3, 5) // 29),
        ("success", column(1, 1)),
    ],
)
def test_function_of_which_there_is_nothing_to_say(entry, values):
    assert remarks([checked(entry, values)]) == ()


def test_direct_functions_are_called_so():
    same = [[1.0, 2.0], NOTHING, [1.0, 2.0]]
    direct = [
        checked("fitness", column(0, 0, 0), kind="direct"),
        checked("descriptor", same, kind="direct"),
    ]

    assert remarks(direct) == (
        "The direct fitness gives the same number for all 3 example motions.",
        "The direct descriptor gives the same numbers for all 3 example motions.",
    )
    assert remarks([checked("descriptor", [[1.0, 2.0], NOTHING, [1.0, 3.0]])]) == ()


def test_numbers_that_are_not_there_are_the_same_in_every_row():
    rows = np.full((2, 3, 5), np.nan)
    rows[..., :2] = 1.0

    assert len(remarks([checked("quantity", rows)])) == 1


def test_timestamps_that_always_agree():
    moments = {"a": (1, 5, -1), "b": (1, 5, 0), "c": (1, 5, -1), "d": (1, 5, -1), "e": (-1,) * 3}
    timestamps = [checked("timestamp", column(*at), name=name) for name, at in moments.items()]

    assert remarks(timestamps) == (
        "The timestamp 'e' is defined on none of the 3 example motions.",
        "The timestamps 'a' and 'c' pick the same moment of each of the 3 example motions.",
        "The timestamps 'a' and 'd' pick the same moment of each of the 3 example motions.",
    )


def test_timestamps_that_are_never_defined_do_not_agree():
    never = [checked("timestamp", column(-1, -1), name=name) for name in "ab"]

    assert len(remarks(never)) == 2


def test_function_without_values_is_passed_over():
    source = FunctionSource(name="a", description="", code="")

    assert remarks([(Candidate(source, "fitness", "fitness"), CheckOutcome())]) == ()
