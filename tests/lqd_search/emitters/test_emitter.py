import numpy as np


def test_found_are_successes_that_got_into_a_cell(batch_of):
    batch = batch_of(np.zeros((4, 1)), success=[1, 1, 0, 1], status=[2, 0, 2, 1])
    assert batch.found.tolist() == [True, False, False, True]
    assert len(batch) == 4


def test_rows_are_the_chosen_solutions_in_their_order(batch_of):
    batch = batch_of(
        np.arange(3.0)[:, None],
        asked=False,
        success=[1, 0, 1],
        status=[0, 1, 2],
        value=[3, 4, 5],
        measures={"a": np.arange(6.0).reshape(3, 2)},
        perceived={"contact": np.arange(3)},
    )
    some = batch.rows(np.array([2, 0]))
    assert some.solutions.tolist() == [[2.0], [0.0]]
    assert some.values.success.tolist() == [True, True]
    assert some.values.measures["a"].tolist() == [[4.0, 5.0], [0.0, 1.0]]
    assert some.values.perceived["contact"].tolist() == [2, 0]
    assert (some.status.tolist(), some.value.tolist()) == ([2, 0], [5.0, 3.0])
    assert not some.asked
    assert len(batch.rows(np.empty(0, np.intp))) == 0
