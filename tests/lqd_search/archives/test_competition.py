import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lqd_search import Candidates, Incumbents, compete_by_coin, compete_by_fitness

# One cell, as (success, objective), or None for an empty one.
FAILURE, GOOD_FAILURE = (False, 1.0), (False, 2.0)
SUCCESS, GOOD_SUCCESS = (True, 1.0), (True, 2.0)
POOR_SUCCESS = (True, -5.0)


def contest(competition, elite, *comers):
    """Let candidates compete for one cell and return the indices of the winners."""
    n = len(comers)
    return competition(
        Candidates(
            cell=np.full(n, 7),
            success=np.array([success for success, _ in comers], bool),
            objective=np.array([objective for _, objective in comers], float),
        ),
        Incumbents(
            occupied=np.full(n, elite is not None),
            success=np.full(n, elite[0] if elite else True),
            objective=np.full(n, elite[1] if elite else np.nan),
        ),
    ).tolist()


@pytest.mark.parametrize(
    ("elite", "comers", "winners"),
    [
        (None, [FAILURE], [0]),
        (None, [SUCCESS], [0]),
        (FAILURE, [POOR_SUCCESS], [0]),
        (POOR_SUCCESS, [GOOD_FAILURE], []),
        (SUCCESS, [GOOD_SUCCESS], [0]),
        (GOOD_SUCCESS, [SUCCESS], []),
        (FAILURE, [GOOD_FAILURE], [0]),
        (GOOD_FAILURE, [FAILURE], []),
        (SUCCESS, [SUCCESS], []),
        (FAILURE, [FAILURE], []),
        (None, [FAILURE, FAILURE], [0]),
        (None, [SUCCESS, GOOD_FAILURE, GOOD_SUCCESS, GOOD_SUCCESS], [2]),
        (FAILURE, [GOOD_FAILURE, POOR_SUCCESS, GOOD_FAILURE], [1]),
        (FAILURE, [], []),
    ],
)
def test_rules_of_one_cell(elite, comers, winners):
    assert contest(compete_by_fitness, elite, *comers) == winners


def test_zeros_of_either_sign_tie():
    assert contest(compete_by_fitness, (False, -0.0), (False, 0.0)) == []
    assert contest(compete_by_fitness, None, (False, -0.0), (False, 0.0)) == [0]


def test_winners_of_several_cells_come_in_the_order_of_the_candidates():
    winners = compete_by_fitness(
        Candidates(
            cell=np.array([9, 2, 9, 0, 2]),
            success=np.array([False, False, True, False, False]),
            objective=np.array([5.0, 1.0, 0.0, 0.0, 3.0]),
        ),
        Incumbents(
            occupied=np.array([True, False, True, True, False]),
            success=np.array([False, False, False, True, False]),
            objective=np.array([4.0, 0.0, 4.0, 0.0, 0.0]),
        ),
    )
    assert winners.tolist() == [2, 4]


class FixedCoins:
    """Stands for a generator that throws these."""

    def __init__(self, *coins):
        self.coins = coins

    def random(self, n):
        assert n == len(self.coins)
        return np.array(self.coins, float)


HEADS, TAILS = 0.2, 0.7


@pytest.mark.parametrize(
    ("elite", "comers", "coins", "winners"),
    [
        (GOOD_FAILURE, [FAILURE], [HEADS], [0]),
        (FAILURE, [GOOD_FAILURE], [TAILS], []),
        (None, [FAILURE], [TAILS], [0]),
        (None, [FAILURE, GOOD_FAILURE], [HEADS, TAILS], [0]),
        (None, [GOOD_FAILURE, FAILURE], [TAILS, HEADS], [1]),
        (FAILURE, [FAILURE, FAILURE, FAILURE], [HEADS, HEADS, TAILS], [1]),
        (POOR_SUCCESS, [GOOD_FAILURE], [HEADS], []),
        (GOOD_FAILURE, [POOR_SUCCESS], [TAILS], [0]),
        (None, [POOR_SUCCESS, GOOD_FAILURE], [TAILS, HEADS], [0]),
        (SUCCESS, [GOOD_SUCCESS], [TAILS], [0]),
        (GOOD_SUCCESS, [SUCCESS], [HEADS], []),
    ],
)
def test_two_failures_toss_a_coin(elite, comers, coins, winners):
    assert contest(compete_by_coin(FixedCoins(*coins)), elite, *comers) == winners


def test_the_coin_is_fair_and_its_state_can_be_pickled():
    competition = compete_by_coin(np.random.default_rng(0))
    wins = sum(contest(competition, GOOD_FAILURE, FAILURE) == [0] for _ in range(1000))
    assert 450 < wins < 550
    twin = pickle.loads(pickle.dumps(competition))
    ours = [contest(competition, FAILURE, GOOD_FAILURE) for _ in range(50)]
    assert ours == [contest(twin, FAILURE, GOOD_FAILURE) for _ in range(50)]


def beats(challenger, elite):
    if challenger[0] != elite[0]:
        return challenger[0]
    return challenger[1] > elite[1]


def one_by_one(cells, elites, comers, *, coins=None):
    """The rule as it is told: insert in order, into a dict of cells."""
    holders = {cell: (None, elite) for cell, elite in elites.items()}
    for i, (cell, comer) in enumerate(zip(cells, comers, strict=True)):
        elite = holders[cell][1] if cell in holders else None
        if elite is None:
            won = True
        elif coins is not None and not comer[0] and not elite[0]:
            won = coins[i] < 0.5
        else:
            won = beats(comer, elite)
        if won:
            holders[cell] = (i, comer)
    return sorted(i for i, _ in holders.values() if i is not None)


SOLUTIONS = st.tuples(st.booleans(), st.sampled_from([-1.0, -0.0, 0.0, 0.5, 1.0, 2.0]))


@st.composite
def batches(draw):
    n = draw(st.integers(0, 30))
    cells = draw(st.lists(st.integers(0, 6), min_size=n, max_size=n))
    comers = draw(st.lists(SOLUTIONS, min_size=n, max_size=n))
    elites = draw(st.dictionaries(st.integers(0, 6), SOLUTIONS, max_size=7))
    return cells, comers, elites


def as_arrays(cells, comers, elites):
    met = [elites.get(cell, (True, np.nan)) for cell in cells]
    return (
        Candidates(
            np.array(cells, np.int32),
            np.array([success for success, _ in comers], bool),
            np.array([objective for _, objective in comers], float),
        ),
        Incumbents(
            np.array([cell in elites for cell in cells], bool),
            np.array([success for success, _ in met], bool),
            np.array([objective for _, objective in met], float),
        ),
    )


@given(batches())
def test_by_fitness_equals_inserting_one_by_one(batch):
    cells, comers, elites = batch
    winners = compete_by_fitness(*as_arrays(cells, comers, elites))
    assert winners.tolist() == one_by_one(cells, elites, comers)


@given(batches(), st.integers(0, 2**32))
def test_by_coin_equals_inserting_one_by_one(batch, seed):
    cells, comers, elites = batch
    coins = np.random.default_rng(seed).random(len(cells))
    competition = compete_by_coin(np.random.default_rng(seed))
    winners = competition(*as_arrays(cells, comers, elites))
    assert winners.tolist() == one_by_one(cells, elites, comers, coins=coins)
