import dataclasses

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lqd_search import Values
from lqd_search.evaluation.concatenation import concatenate_values
from lqd_search.evaluation.functional_calls import RefusedValueError
from lqd_search.evaluation.refusals import Refusals
from lqd_search.evaluation.stopped_functions import WithoutStopped
from lqd_search.evaluation.values import StoppedFunction
from lqd_search.runs.state_pickle import pickle_state, unpickle_state

SUCCESS, HIGH, END, TOUCH, PLACE = (
    StoppedFunction(name, kind, f"was stopped: {name} takes for ever")
    for name, kind in [
        ("success", "success"),
        ("high", "fitness"),
        ("end", "timestamp"),
        ("touch", "timestamp"),
        ("place", "quantity"),
    ]
)
STALLING = (SUCCESS, HIGH, END, TOUCH, (END, PLACE), (TOUCH, PLACE))
"""What a motion may make stall: a functional, or the quantity on the moment of a timestamp."""


class Worker:
    """Judges whole numbers, whose bits say what stalls; it calls nothing again that has stalled."""

    def __init__(self, without):
        self.without = set(without)
        self.stopped = {}
        self.refusals = Refusals()

    def calls(self, function, i, stalls):
        if function in self.without or function in self.stopped or stalls:
            if function not in self.without:
                self.stopped.setdefault(function, None)
            refused = RefusedValueError(function.reason)
            self.refusals.note(i, function.kind, function.functional, refused)
            return False
        return True

    def __call__(self, solutions):
        self.refusals = Refusals()
        n = len(solutions)
        success, high = np.zeros(n, bool), np.full(n, np.nan)
        measures = {f"{h.functional}.place": np.full((n, 2), np.nan) for h in (END, TOUCH)}
        for i, number in enumerate(solutions):
            stalling = {STALLING[k] for k in range(len(STALLING)) if number >> k & 1}
            success[i] = self.calls(SUCCESS, i, SUCCESS in stalling)
            if self.calls(HIGH, i, HIGH in stalling):
                high[i] = number
            for h in (END, TOUCH):
                if self.calls(h, i, h in stalling) and self.calls(PLACE, i, (h, PLACE) in stalling):
                    measures[f"{h.functional}.place"][i] = number, -number
        return Values(
            valid=np.ones(n, bool),
            success=success,
            fitness={"high": high},
            measures=measures,
            refusals=self.refusals.listed(),
            stopped=tuple(self.stopped),
        )


def spread_over(cuts, owners):
    """Make evaluators that share the chunks of a batch among workers, in some order."""

    def make(stopped):
        workers = [Worker(stopped) for _ in range(3)]

        def evaluate(solutions):
            chunks = np.split(solutions, sorted(cut for cut in cuts if cut <= len(solutions)))
            parts = [None] * len(chunks)
            # A later chunk may be judged before an earlier one.
            for i in sorted(range(len(chunks)), key=lambda i: owners[i % len(owners)]):
                parts[i] = workers[owners[i % len(owners)] % 3](chunks[i])
            return concatenate_values(parts)

        return evaluate

    return make


def lasting(make, stopped=()):
    return WithoutStopped(make(tuple(stopped)), make=make, stopped=stopped)


def columns(values):
    plain = dataclasses.asdict(dataclasses.replace(values, refusals=(), passive={}, perceived={}))
    # Where something was first refused depends on what else is, but on nothing that varies here.
    return plain | {"refusals": {(r.kind, r.functional): r for r in values.refusals}}


NUMBERS = st.lists(st.integers(0, 2 ** len(STALLING) - 1) | st.just(0), min_size=1, max_size=8)


@given(
    st.lists(NUMBERS, min_size=1, max_size=3),
    st.lists(st.integers(0, 8), max_size=4),
    st.lists(st.integers(0, 8), min_size=1, max_size=5),
)
def test_neither_chunks_nor_workers_nor_stopping_a_run_change_anything(batches, cuts, owners):
    whole, spread = lasting(spread_over([], [0])), lasting(spread_over(cuts, owners))
    resumed = ()
    for numbers in batches:
        batch = np.array(numbers)
        expected = columns(whole(batch))
        np.testing.assert_equal(columns(spread(batch)), expected)
        going_on = lasting(spread_over(cuts, owners), stopped=resumed)
        np.testing.assert_equal(columns(going_on(batch)), expected)
        resumed = unpickle_state(pickle_state(going_on.stopped))
        assert spread.stopped == whole.stopped == resumed


def test_a_function_counts_as_refused_in_all_of_the_batch_and_from_then_on():
    evaluate = lasting(Worker)
    first, second = (evaluate(np.array(numbers)) for numbers in ([0, 2, 0], [0, 0]))
    assert np.isnan(first.fitness["high"]).all()
    assert np.isnan(second.fitness["high"]).all()
    assert first.success.all()
    assert not np.isnan(first.measures["end.place"]).any()
    assert [(r.functional, r.count, r.reason) for r in first.refusals] == [("high", 3, HIGH.reason)]
    assert [(r.functional, r.count) for r in second.refusals] == [("high", 2)]
    assert (first.stopped, second.stopped) == ((HIGH,), ())
    assert evaluate.stopped == (HIGH,)


def test_a_quantity_that_stalls_on_the_moments_of_a_stopped_timestamp_alone_is_kept():
    evaluate = lasting(Worker)
    values = evaluate(np.array([0, 16, 4]))
    assert values.stopped == (END,)
    assert not np.isnan(values.measures["touch.place"]).any()
    assert evaluate(np.array([32])).stopped == (PLACE,)


def test_without_a_stopped_function_a_batch_is_evaluated_once():
    batches = []

    def make(stopped):
        assert stopped == ()

        def evaluate(solutions):
            batches.append(solutions)
            return Worker(stopped)(solutions)

        return evaluate

    values = lasting(make)(np.array([0, 0]))
    assert values.stopped == ()
    assert len(batches) == 1


def test_an_evaluator_that_stops_what_it_should_not_call_is_not_asked_for_ever():
    evaluate = WithoutStopped(Worker([]), make=lambda _: Worker([]), stopped=[])
    assert evaluate(np.array([1])).stopped == (SUCCESS,)


def test_the_sentence_names_the_function_and_the_reason():
    assert str(HIGH) == (
        "The fitness function 'high' is not used any more: it was stopped: high takes for ever."
    )


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
def test_of_several_chunks_the_first_one_gives_the_reason(order):
    reasons = [dataclasses.replace(HIGH, reason=f"reason {k}") for k in order]
    parts = [dataclasses.replace(Worker([])(np.array([0])), stopped=(one,)) for one in reasons]
    assert concatenate_values(parts).stopped == (reasons[0],)
