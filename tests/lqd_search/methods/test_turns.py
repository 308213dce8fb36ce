import pickle

import numpy as np
import pytest

from lqd_search import MethodError
from lqd_search.methods.turns import Turns


def take(turns):
    turns.ask(np.zeros((turns.size(), 2)))
    turns.tell()


def test_the_last_generation_takes_what_is_left():
    turns = Turns(1_025, 50)
    sizes = []
    while not turns.done:
        sizes.append(turns.size())
        take(turns)
    assert sizes == [50] * 20 + [25]
    assert turns.evaluations == 1_025


def test_what_is_evaluated_is_a_copy_of_what_is_kept():
    turns = Turns(4, 4)
    solutions = np.arange(8.0).reshape(4, 2)
    given = turns.ask(solutions)
    given[:] = -1.0
    np.testing.assert_array_equal(turns.asked(), np.arange(8.0).reshape(4, 2))


def test_asking_twice_is_an_error():
    turns = Turns(8, 4)
    turns.ask(np.zeros((turns.size(), 2)))
    with pytest.raises(MethodError, match="no further call of ask, since the last ones were not"):
        turns.size()


def test_asking_when_all_is_spent_is_an_error():
    turns = Turns(4, 4)
    take(turns)
    with pytest.raises(MethodError, match="no further call of ask, since all evaluations are spen"):
        turns.size()


@pytest.mark.parametrize("call", [Turns.asked, Turns.tell])
def test_telling_before_asking_is_an_error(call):
    turns = Turns(8, 4)
    take(turns)
    with pytest.raises(MethodError, match="Expected a call of ask before tell"):
        call(turns)


def test_turns_go_on_after_pickling_between_asking_and_telling():
    turns = Turns(6, 4)
    turns.ask(np.ones((turns.size(), 2)))
    again = pickle.loads(pickle.dumps(turns))
    np.testing.assert_array_equal(again.asked(), np.ones((4, 2)))
    again.tell()
    assert (again.evaluations, again.size()) == (4, 2)
