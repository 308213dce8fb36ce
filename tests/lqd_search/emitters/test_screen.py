import pickle

import numpy as np
import pytest

from lqd_search import EmitterError, ValuesError
from lqd_search.emitters.screen import NeighbourScreen, carried_out
from lqd_search.evaluation.contact import touched


def screen_that_saw(batch_of, places, *, worth, **options):
    """A screen to which these places on a line were worth their evaluation or not."""
    screen = NeighbourScreen(**options)
    screen.tell(seen(batch_of, places, worth=worth))
    return screen


def seen(batch_of, places, *, worth):
    return batch_of(np.array(places, float)[:, None], valid=np.array(worth, bool))


def choose(screen, *candidates):
    return screen.choose(np.array(candidates, float)[:, :, None])[:, 0].tolist()


def test_it_is_ready_once_it_saw_as_many_as_have_a_say(batch_of):
    screen = NeighbourScreen(neighbours=3)
    assert not screen.ready
    screen.tell(seen(batch_of, [0, 1], worth=[1, 1]))
    assert not screen.ready
    screen.tell(seen(batch_of, [2], worth=[1]))
    assert screen.ready
    assert screen.candidates == 3


def test_the_first_candidate_with_a_neighbour_worth_it_is_taken(batch_of):
    screen = screen_that_saw(batch_of, [0, 10, 20, 30], worth=[0, 1, 0, 1], neighbours=1)
    # The parents' candidates are columns: 10 and 30 were worth it, 0 and 20 were not.
    assert choose(screen, [11, 1, 1], [9, 9, 19], [31, 31, 31]) == [11.0, 9.0, 31.0]


def test_where_no_candidate_is_promising_the_first_is_taken(batch_of):
    screen = screen_that_saw(batch_of, [0, 10, 20], worth=[0, 0, 1], neighbours=1)
    assert choose(screen, [1], [2], [9]) == [1.0]


def test_one_neighbour_of_several_is_enough(batch_of):
    screen = screen_that_saw(batch_of, [0, 1, 2, 50], worth=[0, 0, 1, 0], neighbours=3)
    assert choose(screen, [50, 60], [0, 0]) == [50.0, 60.0]
    screen = screen_that_saw(batch_of, [0, 1, 2, 50, 51, 52], worth=[1, 0, 0, 0, 0, 0])
    assert choose(screen, [50], [0]) == [0.0]


def test_only_the_last_solutions_are_remembered(batch_of):
    screen = screen_that_saw(batch_of, [0, 1, 2], worth=[1, 1, 1], neighbours=1, memory=4)
    screen.tell(seen(batch_of, [10, 11, 12], worth=[0, 0, 0]))
    # Of the first batch the last one is left.
    assert choose(screen, [10, 10], [3, 11]) == [3.0, 10.0]
    screen.tell(seen(batch_of, [20], worth=[0]))
    assert choose(screen, [10], [3]) == [10.0]


def test_no_children_may_be_chosen_from(batch_of):
    screen = screen_that_saw(batch_of, [0, 1, 2], worth=[1, 1, 1])
    assert screen.choose(np.empty((3, 0, 1))).shape == (0, 1)


def test_a_pickle_holds_no_tree_and_goes_on_alike(batch_of):
    screen = screen_that_saw(batch_of, np.arange(40), worth=np.arange(40) % 3 == 0)
    candidates = np.random.default_rng(0).uniform(0, 40, (3, 20, 1))
    before = screen.choose(candidates)
    pickled = pickle.dumps(screen)
    assert b"KDTree" not in pickled
    twin = pickle.loads(pickled)
    assert np.array_equal(twin.choose(candidates), before)
    assert np.array_equal(screen.choose(candidates), before)


def test_what_is_worth_an_evaluation(batch_of):
    contact = np.array([[np.nan] * 6, [0.0] * 6])
    batch = batch_of(
        np.zeros((2, 1)), valid=np.array([True, False]), perceived={"contact": contact}
    )
    assert carried_out(batch.values).tolist() == [True, False]
    assert touched(batch.values).tolist() == [False, True]


def test_without_contacts_nobody_knows_who_touched_the_object(batch_of):
    with pytest.raises(ValuesError, match=r"column 'contact' among the values.* only none; eval"):
        NeighbourScreen(worth=touched).tell(batch_of(np.zeros((2, 1))))


@pytest.mark.parametrize(
    ("options", "shown"),
    [
        ({"candidates": 0}, "0, 3 and 20000"),
        ({"neighbours": 0}, "3, 0 and 20000"),
        ({"memory": 0}, "3, 3 and 0"),
        ({"neighbours": 9, "memory": 8}, "3, 9 and 8"),
    ],
)
def test_numbers_that_are_too_low_are_refused(options, shown):
    with pytest.raises(EmitterError, match=f"^Expected at least 1 candidate, .* but got {shown};"):
        NeighbourScreen(**options)


def test_a_memory_of_as_many_as_have_a_say_will_do(batch_of):
    screen = screen_that_saw(batch_of, [0, 1, 2], worth=[1, 1, 0], neighbours=2, memory=2)
    assert choose(screen, [0]) == [0.0]
