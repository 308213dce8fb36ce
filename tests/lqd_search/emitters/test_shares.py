from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from lqd_search import EmitterError
from lqd_search.emitters.shares import CreditedShares, EvenShares, ManyCellShares


def grids(*cells):
    """Stand-ins for grids, of which shares read the number of cells alone."""
    return {f"g{i}": SimpleNamespace(cells=count) for i, count in enumerate(cells)}


@given(st.integers(0, 3000), st.integers(1, 20))
def test_even_shares_are_even_and_the_first_grids_take_the_rest(n, count):
    split = EvenShares().split(n, grids=grids(*[9] * count))
    shares = [split.get(f"g{i}", 0) for i in range(count)]
    assert sum(shares) == n
    assert shares == sorted(shares, reverse=True)
    assert shares[0] - shares[-1] <= 1
    assert list(split) == [f"g{i}" for i in range(count) if shares[i]]


def test_even_shares_learn_nothing():
    shares = EvenShares()
    shares.tell(asked={"g0": 8, "g1": 8}, found={"g0": 8, "g1": 0})
    assert shares.split(5, grids=grids(9, 9)) == {"g0": 3, "g1": 2}


def test_grids_with_a_single_cell_get_no_parents():
    assert ManyCellShares().split(5, grids=grids(1, 2, 1, 100)) == {"g1": 3, "g3": 2}


def test_where_all_have_a_single_cell_they_share_evenly():
    assert ManyCellShares().split(3, grids=grids(1, 1)) == {"g0": 2, "g1": 1}


def test_what_many_cell_shares_are_told_the_inner_rule_learns():
    inner = CreditedShares()
    ManyCellShares(inner).tell(asked={"g1": 4}, found={"g1": 3})
    assert (inner.asked, inner.found) == ({"g1": 4.0}, {"g1": 3.0})


def test_as_long_as_nothing_was_found_credited_shares_are_even():
    shares = CreditedShares()
    assert shares.split(8, grids=grids(9, 9, 9)) == {"g0": 3, "g1": 3, "g2": 2}
    shares.tell(asked={"g0": 3, "g1": 3, "g2": 2}, found={"g0": 0, "g1": 0, "g2": 0})
    assert shares.split(8, grids=grids(9, 9, 9)) == {"g0": 3, "g1": 3, "g2": 2}


def test_half_is_shared_by_credit():
    shares = CreditedShares()
    # Credits of 1/2, 1/4 and 0: two thirds and a third of half of the parents.
    shares.tell(asked={"g0": 8, "g1": 8, "g2": 8}, found={"g0": 4, "g1": 2, "g2": 0})
    assert shares.split(60, grids=grids(9, 9, 9)) == {"g0": 30, "g1": 20, "g2": 10}


def test_counts_fade_from_generation_to_generation():
    shares = CreditedShares(fading=0.5)
    shares.tell(asked={"g0": 8, "g1": 8}, found={"g0": 8, "g1": 0})
    shares.tell(asked={"g1": 8}, found={"g1": 2})
    assert shares.asked == {"g0": 4.0, "g1": 12.0}
    assert shares.found == {"g0": 4.0, "g1": 2.0}


def test_a_grid_that_has_no_part_in_a_generation_gets_none_of_it():
    shares = CreditedShares()
    shares.tell(asked={"g0": 8, "g1": 8}, found={"g0": 8, "g1": 0})
    only = {"g1": SimpleNamespace(cells=9)}
    assert shares.split(7, grids=only) == {"g1": 7}


counts = st.lists(st.tuples(st.floats(0, 1e6), st.floats(0, 1e6)), min_size=1, max_size=20)


@given(st.integers(0, 3000), counts, st.floats(0, 1))
@example(7, [(0.0, 5e-324)] * 3, 0.5)
@example(3, [(1.0, 1.0)] * 3, 0.1)
@example(512, [(1.0, 0.3)] * 16, 0.0)
def test_credited_shares_give_out_every_parent_and_are_the_same_each_time(n, faded, even):
    names = [f"g{i}" for i in range(len(faded))]
    shares = CreditedShares(
        even=even,
        asked=dict(zip(names, (asked for asked, _ in faded), strict=True)),
        found=dict(zip(names, (found for _, found in faded), strict=True)),
    )
    of = grids(*[9] * len(faded))
    split = shares.split(n, grids=of)
    assert sum(split.values()) == n
    assert all(type(count) is int and count > 0 for count in split.values())
    assert list(split) == [name for name in of if name in split]
    assert shares.split(n, grids=of) == split
    # Nobody gets less than the part that is shared evenly, rounded down.
    least = min(split.get(name, 0) for name in of)
    assert least >= np.floor(n * even / len(of) * (1 - 1e-12))


@pytest.mark.parametrize("share", [0.0, 1.0])
def test_all_or_nothing_may_be_even(share):
    shares = CreditedShares(even=share)
    shares.tell(asked={"g0": 4, "g1": 4}, found={"g0": 4, "g1": 0})
    split = shares.split(6, grids=grids(9, 9))
    assert split == ({"g0": 3, "g1": 3} if share else {"g0": 6})


@pytest.mark.parametrize(
    "options", [{"even": -0.1}, {"even": 1.1}, {"even": np.nan}, {"fading": -0.1}, {"fading": 1.0}]
)
def test_parts_outside_their_interval_are_refused(options):
    with pytest.raises(EmitterError, match="Expected an even part from 0 to 1 and a fading from 0"):
        CreditedShares(**options)
