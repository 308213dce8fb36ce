import math

import numpy as np
import pytest

from lqd_search.evaluation.functional_calls import (
    RefusedValueError,
    call_descriptor,
    call_fitness,
    call_quantity,
    call_success,
    call_timestamp,
)

INFOS = [{"t": float(t)} for t in range(4)]


def test_what_fits_is_given_back_in_plain_python():
    assert call_success(lambda infos: np.bool_(len(infos) == 4), INFOS) is True
    assert call_fitness(lambda info: np.float64(info["t"]), INFOS) == 1.5
    assert call_timestamp(lambda infos: infos[2], INFOS) is INFOS[2]
    assert call_timestamp(lambda _: None, INFOS) is None
    numbers = call_quantity(lambda info: [np.int64(1), info["t"], True], INFOS[2])
    assert numbers == (1.0, 2.0, 1.0)
    assert {type(number) for number in numbers} == {float}
    assert call_descriptor(lambda infos: (len(infos), infos[-1]["t"]), INFOS) == (4.0, 3.0)
    assert call_descriptor(lambda _: None, INFOS) is None


def test_the_mean_is_exactly_rounded():
    numbers = iter([1e16, 1.0, -1e16, 1.0])
    assert call_fitness(lambda _: next(numbers), INFOS) == 0.5


@pytest.mark.parametrize("call", [call_success, call_timestamp, call_descriptor])
def test_whole_motions_are_lists_of_its_own(call):
    def emptying(infos):
        infos.clear()
        return {call_success: True}.get(call)

    call(emptying, INFOS)
    assert len(INFOS) == 4


@pytest.mark.parametrize("call", [call_quantity, call_descriptor])
@pytest.mark.parametrize(
    ("result", "reason"),
    [
        ((1.0,), "returned 1 numbers, not between 2 and 5"),
        ((1.0,) * 6, "returned 6 numbers, not between 2 and 5"),
        ((), "returned 0 numbers, not between 2 and 5"),
        ((1.0, "2"), "returned a value of type str, not a number"),
        ((1.0, 2j), "returned a value of type complex, not a number"),
        ((1.0, math.nan), "returned NaN"),
        ((-math.inf, 1.0), "returned infinity"),
        ((1.0, 10**400), "returned an integer too large for a float"),
        ("ab", "returned a value of type str, not a tuple of numbers"),
        ({1.0, 2.0}, "returned a value of type set, not a tuple of numbers"),
        (False, "returned a value of type bool, not a tuple of numbers"),
    ],
)
def test_numbers_that_do_not_fit_are_refused(call, result, reason):
    with pytest.raises(RefusedValueError, match=f"^{reason}$"):
        call(lambda _: result, INFOS)


@pytest.mark.parametrize(
    "call", [call_success, call_fitness, call_timestamp, call_quantity, call_descriptor]
)
def test_whatever_is_raised_is_refused_and_interrupts_are_not(call):
    def failing(_):
        raise LookupError("secret")

    def interrupted(_):
        raise KeyboardInterrupt

    with pytest.raises(RefusedValueError, match=r"^raised LookupError in line \d+$"):
        call(failing, INFOS)
    with pytest.raises(KeyboardInterrupt):
        call(interrupted, INFOS)
