import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lqd_search import MESEmitter
from lqd_search.emitters.evolution_emitter import EvolutionEmitter
from lqd_search.emitters.mixed_emitter import EmitterError, MixedEmitter, Part
from lqd_search.emitters.random_emitter import RandomEmitter
from lqd_search.solution_space import BoxSpace

BOX = BoxSpace([0.0], [10.0])


class Numbered:
    """An emitter whose solutions are its number, and that notes what it is told."""

    def __init__(self, number):
        self.number = number
        self.told = []

    def ask(self, n, *, archive, rng):  # noqa: ARG002 -- the protocol's
        return np.full((n, 1), float(self.number))

    def tell(self, batch, *, archive):  # noqa: ARG002 -- the protocol's
        self.told.append((batch.asked, batch.solutions[:, 0].tolist(), batch.value.tolist()))


def mixed(*shares):
    emitters = [Numbered(i) for i in range(1 + len(shares))]
    parts = [Part(e, share) for e, share in zip(emitters[1:], shares, strict=True)]
    return emitters, MixedEmitter(emitters[0], parts)


def ask(emitter, n):
    return emitter.ask(n, archive=None, rng=np.random.default_rng(0))


def test_each_has_its_share_rounded_down_and_the_main_one_the_rest():
    _, emitter = mixed(0.25, 0.1)
    assert ask(emitter, 19)[:, 0].tolist() == [0.0] * 14 + [1.0] * 4 + [2.0]


@given(st.integers(0, 600), st.lists(st.floats(0.001, 0.24), max_size=4))
def test_they_make_as_many_as_are_asked_for(n, shares):
    _, emitter = mixed(*shares)
    solutions = ask(emitter, n)
    assert solutions.shape == (n, 1)
    assert (np.diff(solutions[:, 0]) >= 0).all()
    assert n == 0 or solutions[0] == 0.0


def test_each_is_told_of_its_own_as_asked_for_and_of_the_others_as_not(batch_of):
    emitters, emitter = mixed(0.25, 0.25)
    solutions = ask(emitter, 4)
    emitter.tell(batch_of(solutions, value=[10, 11, 12, 13]), archive=None)
    assert [e.told for e in emitters] == [
        [(True, [0.0, 0.0], [10.0, 11.0]), (False, [1.0, 2.0], [12.0, 13.0])],
        [(True, [1.0], [12.0]), (False, [0.0, 0.0, 2.0], [10.0, 11.0, 13.0])],
        [(True, [2.0], [13.0]), (False, [0.0, 0.0, 1.0], [10.0, 11.0, 12.0])],
    ]


def test_of_what_somebody_else_made_all_are_told_as_it_is(batch_of):
    emitters, emitter = mixed(0.25)
    emitter.tell(batch_of(np.full((3, 1), 7.0), asked=False), archive=None)
    assert [e.told for e in emitters] == [[(False, [7.0] * 3, [0.0] * 3)]] * 2


@pytest.mark.parametrize("n", [0, 1, 2, 3, 5, 20])
def test_real_emitters_stand_a_share_of_nothing(archive_of, batch_of, n):
    archive = archive_of({"a": [1, 2, 3]}, success=[1, 0, 1])
    parts = [Part(RandomEmitter(BOX), 0.2), Part(EvolutionEmitter(BOX), 0.2)]
    emitter = MixedEmitter(MESEmitter(BOX), parts)
    rng = np.random.default_rng(0)
    for _ in range(2):
        solutions = emitter.ask(n, archive=archive, rng=rng)
        assert solutions.shape == (n, 1)
        emitter.tell(batch_of(solutions), archive=archive)


def test_mixed_emitters_can_be_mixed_and_pickled(batch_of):
    _, inner = mixed(0.5)
    outer = MixedEmitter(Numbered(9), [Part(inner, 0.5)])
    assert ask(outer, 8)[:, 0].tolist() == [9.0] * 4 + [0.0] * 2 + [1.0] * 2
    outer.tell(batch_of(np.zeros((8, 1))), archive=None)
    twin = pickle.loads(pickle.dumps(outer))
    assert ask(twin, 7).tolist() == ask(outer, 7).tolist()


@pytest.mark.parametrize("shares", [[0.0], [-0.1], [1.0], [0.5, 0.5], [0.2, 0.0], [np.nan]])
def test_something_must_be_left_to_the_main_emitter(shares):
    with pytest.raises(EmitterError, match=r"shares above 0 whose sum is below 1.*but got \["):
        mixed(*shares)


def test_a_share_that_is_whole_but_for_its_rounding_is_whole():
    _, emitter = mixed(0.29)
    assert ask(emitter, 100)[:, 0].sum() == 29


@pytest.mark.parametrize("share", [0.05, 0.2])
def test_the_shares_of_ours_plus_are_what_they_were(share):
    n = np.arange(200_000)
    assert np.array_equal(np.floor(share * n + 1e-9), (share * n).astype(int))
