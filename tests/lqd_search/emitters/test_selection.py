import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lqd_search import SelectionError, select_parents

S, F = True, False


def rng():
    return np.random.default_rng(3)


def test_enough_successes_are_drawn_without_replacement():
    success = np.array([F, S, S, F, S, S])
    parents = select_parents(3, success=success, rng=rng())
    assert len(set(parents)) == 3
    assert success[parents].all()


def test_each_success_has_the_same_chance():
    success = np.array([F, S, S, F, S])
    generator = rng()
    drawn = [select_parents(1, success=success, rng=generator)[0] for _ in range(3000)]
    counts = np.bincount(drawn, minlength=5)
    assert counts[[0, 3]].tolist() == [0, 0]
    assert (abs(counts[[1, 2, 4]] - 1000) < 100).all()


def test_all_successes_then_others_without_replacement():
    success = np.array([F, S, F, F, S, F])
    parents = select_parents(4, success=success, rng=rng())
    assert {1, 4} < set(parents)
    assert len(set(parents)) == 4


def test_as_many_elites_as_parents_are_all_taken():
    parents = select_parents(3, success=np.array([F, S, F]), rng=rng())
    assert sorted(parents) == [0, 1, 2]


def test_fewer_elites_than_parents_are_drawn_with_replacement_whatever_they_are():
    parents = select_parents(3000, success=np.array([F, S, F]), rng=rng())
    assert (abs(np.bincount(parents) - 1000) < 100).all()


def test_no_parents_may_be_asked_for():
    assert select_parents(0, success=np.array([F]), rng=rng()).tolist() == []


@pytest.mark.parametrize(("n", "success"), [(2, []), (-1, [S])])
def test_parents_cannot_come_from_nowhere(n, success):
    with pytest.raises(SelectionError, match=f"but got {n} from {len(success)}"):
        select_parents(n, success=np.array(success, bool), rng=rng())


@given(st.integers(0, 40), st.lists(st.booleans(), min_size=1, max_size=30), st.integers(0, 99))
def test_the_rule_holds_for_any_grid(n, flags, seed):
    success = np.array(flags)
    parents = select_parents(n, success=success, rng=np.random.default_rng(seed))
    assert parents.shape == (n,)
    assert ((parents >= 0) & (parents < len(flags))).all()
    if success.sum() >= n:
        assert success[parents].all()
    elif len(flags) >= n:
        assert set(np.flatnonzero(success)) <= set(parents)
    if len(flags) >= n:
        assert len(set(parents)) == n
