import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from lqd_search.archives import distinct
from lqd_search.archives.distinct import first_of_each, first_of_equal, hash_rows

FEW = st.sampled_from([-1.0, -0.0, 0.0, 0.5, 1.0, 5e-324, 1e308])
ROWS = arrays(np.float64, st.tuples(st.integers(0, 30), st.integers(1, 3)), elements=FEW)


def naive_first(rows):
    return [next(j for j in range(i + 1) if (rows[j] == rows[i]).all()) for i in range(len(rows))]


@given(ROWS)
@settings(deadline=None)
def test_the_first_of_equal_rows_is_found(rows):
    assert first_of_equal(rows).tolist() == naive_first(rows)


@pytest.mark.parametrize("different", [1, 2])
@given(ROWS)
@settings(deadline=None)
def test_forged_hashes_do_not_matter(different, rows):
    def forged(rows):
        return (np.abs(rows[:, 0]) > 0.1).astype(np.uint64) % np.uint64(different)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(distinct, "hash_rows", forged)
        assert first_of_equal(rows).tolist() == naive_first(rows)


def test_hashes_of_unequal_rows_differ():
    grid = np.arange(40.0)
    rows = np.stack(np.meshgrid(grid, grid, grid), axis=-1).reshape(-1, 3)
    assert len(np.unique(hash_rows(rows))) == len(rows)
    assert hash_rows(np.array([[0.0, -0.0]])) == hash_rows(np.array([[-0.0, 0.0]]))


@pytest.mark.parametrize("dtype", [np.int8, np.uint8, np.int64, np.uint64, np.float64, bool])
@given(data=st.data())
@settings(deadline=None)
def test_the_first_of_each_id_is_found(dtype, data):
    elements = {"allow_nan": False} if dtype is np.float64 else None
    ids = data.draw(arrays(dtype, st.integers(0, 40), elements=elements))
    _, first, place = np.unique(ids, return_index=True, return_inverse=True)
    found, places = first_of_each(ids)
    assert found.tolist() == first.tolist()
    assert places.tolist() == place.tolist()


@pytest.mark.parametrize("low", [-(2**63), -3, 0, 2**63 - 40])
def test_dense_ids_may_lie_anywhere(low):
    ids = np.array([low + i for i in (5, 3, 5, 0, 3, 9)], np.int64)
    first, place = first_of_each(ids)
    assert first.tolist() == [3, 1, 0, 5]
    assert place.tolist() == [2, 1, 2, 0, 1, 3]
