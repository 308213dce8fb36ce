"""Which motions were looked at, in a few characters."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchmarks.instances.looked_at import LookedAt


@given(data=st.data(), n=st.integers(0, 40))
def test_it_is_read_as_it_was_written_in_the_order_of_evaluation(data, n):
    bits = st.lists(st.booleans(), min_size=n, max_size=n)
    looked, solved = (np.array(data.draw(bits), bool) for _ in range(2))
    evaluation = np.array(data.draw(st.permutations(range(n))), np.int64)

    found = LookedAt.of(np.flatnonzero(looked), solved, evaluation=evaluation)

    which, solve = found.masks()
    assert which.tolist() == looked[np.argsort(evaluation)].tolist()
    assert solve.tolist() == (looked & solved)[np.argsort(evaluation)].tolist()
    assert (found.elites, found.motions, found.solving) == (n, which.sum(), solve.sum())


def test_a_draw_of_500_takes_about_a_kilobyte():
    rng = np.random.default_rng(0)
    rows = rng.choice(10_000, 540, replace=False)

    found = LookedAt.of(rows, rng.random(10_000) < 0.3, evaluation=np.arange(10_000))

    assert len(found.which) + len(found.which_solve) < 1200


@pytest.mark.parametrize("change", [{"elites": 17}, {"motions": 2}, {"solving": 0}])
def test_numbers_that_do_not_go_with_the_bits_are_an_error(change):
    found = LookedAt.of(np.array([0, 2, 3]), np.arange(16) == 2, evaluation=np.arange(16))

    with pytest.raises(ValueError, match="bits"):
        LookedAt(**(vars(found) | change)).masks()
