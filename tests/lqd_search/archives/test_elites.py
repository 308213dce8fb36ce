import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lqd_search.archives import distinct
from lqd_search.archives.elites import unite

EMPTY = {
    "solution": np.empty((0, 2)),
    "objective": np.empty(0),
    "success": np.empty(0, bool),
    "evaluation": np.empty(0, np.int64),
}


def slowly_united(grids, *, evaluated):
    """The union as it is told: one row after the other, each compared with all before it."""
    rows = [(name, i) for name, grid in grids.items() for i in range(len(grid["index"]))]
    if evaluated:
        rows.sort(key=lambda row: grids[row[0]]["evaluation"][row[1]])
    union, place = [], {}
    for name, i in rows:
        solution = grids[name]["solution"][i]
        equal = [j for j, (n, k) in enumerate(union) if (grids[n]["solution"][k] == solution).all()]
        place[name, i] = equal[0] if equal else len(union)
        if not equal:
            union.append((name, i))
    return union, place


VALUES = st.sampled_from([-1.0, -0.0, 0.0, 2.0])


@st.composite
def grids_of_elites(draw, *, honest=False):
    grids = {}
    for name in draw(st.sampled_from([[], ["a"], ["a", "b", "c"]])):
        n = draw(st.integers(0, 12))
        evaluation = draw(st.lists(st.integers(-4, 20), min_size=n, max_size=n))
        if honest:
            # One solution for each evaluation, and for some solutions several of these.
            solution = [[evaluation[i] // 3, -0.0 if evaluation[i] % 2 else 0.0] for i in range(n)]
        else:
            solution = draw(st.lists(st.tuples(VALUES, VALUES), min_size=n, max_size=n))
        grids[name] = {
            "solution": np.array(solution, float).reshape(n, 2),
            # Distinct, so that the comparison shows whose row it is.
            "objective": 100.0 * len(grids) + np.arange(n),
            "success": np.arange(n) % 2 == 0,
            "evaluation": np.array(evaluation, np.int64),
            "index": np.cumsum([*draw(st.lists(st.integers(1, 5), min_size=n, max_size=n))]).astype(
                np.int32
            ),
        }
    return grids


def check_union(grids, *, evaluated):
    empty = {name: none for name, none in EMPTY.items() if evaluated or name != "evaluation"}
    union, place = slowly_united(grids, evaluated=evaluated)
    elites = unite(grids, empty=empty)
    assert list(elites.fields) == list(empty)
    for field, none in empty.items():
        expected = np.array([grids[name][field][i] for name, i in union], none.dtype)
        assert elites.fields[field].dtype == none.dtype
        # As bytes, since the zeros of either sign are equal.
        assert elites.fields[field].tobytes() == expected.tobytes()
    for name, grid in grids.items():
        assert elites.rows[name].tolist() == [place[name, i] for i in range(len(grid["index"]))]
        assert elites.cells[name].tolist() == grid["index"].tolist()


@pytest.mark.parametrize("evaluated", [True, False])
@given(grids=st.one_of(grids_of_elites(), grids_of_elites(honest=True)))
@settings(deadline=None)
def test_the_union_is_that_of_comparing_one_by_one(evaluated, grids):
    check_union(grids, evaluated=evaluated)


@pytest.mark.parametrize("evaluated", [True, False])
@given(grids=st.one_of(grids_of_elites(), grids_of_elites(honest=True)))
@settings(deadline=None)
def test_it_is_so_even_if_all_hashes_collide(evaluated, grids):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(distinct, "hash_rows", lambda rows: np.zeros(len(rows), np.uint64))
        check_union(grids, evaluated=evaluated)
