import pickle

import numpy as np
import pytest

from lqd_search import MESEmitter, SelectionError
from lqd_search.emitters.shares import EvenShares


class Marking:
    """A space whose mutants are their parents, marked by a hundred."""

    dim = 1

    def sample(self, n, *, rng):  # noqa: ARG002 -- the protocol's
        raise AssertionError("nothing was to be sampled")

    def mutate(self, parents, *, rng):  # noqa: ARG002 -- the protocol's
        return parents + 100.0


class Learning:
    """Even shares that note what they are told."""

    def __init__(self):
        self.told = []

    def split(self, n, *, grids):
        return EvenShares().split(n, grids=grids)

    def tell(self, *, asked, found):
        self.told.append((dict(asked), dict(found)))


class Lopsided:
    """Shares that leave a grid with none, and say so."""

    def split(self, n, *, grids):
        first, *others = grids
        return {first: 0} | dict.fromkeys(others, n)

    def tell(self, *, asked, found):
        pass


class LastCandidate:
    """A screen that takes the last of two candidates, once it is ready."""

    candidates = 2

    def __init__(self):
        self.ready = False
        self.told = []

    def choose(self, candidates):
        assert candidates.shape[0] == 2
        return candidates[-1]

    def tell(self, batch):
        self.told.append(len(batch))


def ask(emitter, n, archive, *, seed=0):
    return emitter.ask(n, archive=archive, rng=np.random.default_rng(seed))[:, 0].tolist()


@pytest.fixture
def one_grid(archive_of):
    return lambda success: archive_of({"a": np.arange(len(success)) + 0.5}, success=success)


@pytest.fixture
def two_grids(archive_of):
    """Solutions 0 and 1 lie in the first grid only, 2 and 3 in the second."""
    return archive_of({"a": [1, 2, None, None], "b": [None, None, 3, 4]}, success=[0, 1, 0, 0])


def test_it_mutates_successes_first(one_grid):
    emitter, archive = MESEmitter(Marking()), one_grid([True, False, True, True])
    assert sorted(ask(emitter, 3, archive)) == [100.0, 102.0, 103.0]
    assert sorted(ask(emitter, 4, archive)) == [100.0, 101.0, 102.0, 103.0]


def test_every_grid_has_its_children_one_after_the_other(two_grids):
    solutions = ask(MESEmitter(Marking()), 3, two_grids)
    assert sorted(solutions[:2]) == [100.0, 101.0]
    assert solutions[2] in (102.0, 103.0)


def test_a_grid_that_is_empty_is_passed_over(archive_of):
    archive = archive_of({"a": [None, None], "b": [1, 2]}, success=[0, 0])
    assert sorted(ask(MESEmitter(Marking()), 2, archive)) == [100.0, 101.0]


def test_what_it_makes_depends_on_the_generator_alone(one_grid):
    emitter, archive = MESEmitter(Marking()), one_grid([False] * 6)
    assert ask(emitter, 4, archive, seed=5) == ask(emitter, 4, archive, seed=5)


def test_the_order_in_which_cells_were_filled_does_not_matter(one_grid):
    archive, reverse = one_grid([True, False, True, True]), one_grid([])
    elites = archive.grid_elites("a")
    for i in reversed(range(4)):
        reverse.add_single(
            elites["solution"][i],
            elites["objective"][i],
            elites["measures"][i],
            success=elites["success"][i],
        )
    asked = [ask(MESEmitter(Marking()), 6, a, seed=5) for a in (archive, reverse)]
    assert asked[0] == asked[1]


def test_there_must_be_an_elite(one_grid):
    with pytest.raises(SelectionError, match="at least one elite to select 7 parents from"):
        ask(MESEmitter(Marking()), 7, one_grid([]))


@pytest.mark.parametrize("ready", [False, True])
def test_nothing_may_be_asked_for(two_grids, batch_of, ready):
    screen = LastCandidate()
    screen.ready = ready
    for emitter in (MESEmitter(Marking()), MESEmitter(Marking(), screen=screen)):
        solutions = emitter.ask(0, archive=two_grids, rng=np.random.default_rng(0))
        assert solutions.shape == (0, 1)
        emitter.tell(batch_of(solutions), archive=two_grids)


def test_a_grid_may_be_given_no_parents(two_grids, batch_of):
    emitter = MESEmitter(Marking(), shares=Lopsided())
    assert sorted(ask(emitter, 2, two_grids)) == [102.0, 103.0]
    emitter.tell(batch_of(np.zeros((2, 1))), archive=two_grids)


def test_the_shares_are_told_what_each_grids_children_found(two_grids, batch_of):
    shares = Learning()
    emitter = MESEmitter(Marking(), shares=shares)
    ask(emitter, 5, two_grids)
    solutions = np.zeros((5, 1))
    emitter.tell(
        batch_of(solutions, success=[1, 1, 0, 1, 1], status=[1, 0, 2, 0, 2]), archive=two_grids
    )
    assert shares.told == [({"a": 3, "b": 2}, {"a": 1, "b": 1})]
    # What somebody else made says nothing about the grids.
    emitter.tell(batch_of(np.zeros((7, 1)), asked=False), archive=two_grids)
    assert len(shares.told) == 1


def test_a_screen_chooses_once_it_is_ready_and_sees_every_batch(two_grids, batch_of):
    def counting(elites, parents, *, rng):  # noqa: ARG001 -- the protocol's
        return np.full((len(parents), 1), float(next(calls)))

    calls = iter(range(10))
    screen = LastCandidate()
    emitter = MESEmitter(Marking(), variation=counting, screen=screen)
    # Two grids, one candidate each.
    assert ask(emitter, 2, two_grids) == [0.0, 1.0]
    emitter.tell(batch_of(np.zeros((2, 1))), archive=two_grids)
    emitter.tell(batch_of(np.zeros((3, 1)), asked=False), archive=two_grids)
    assert screen.told == [2, 3]
    screen.ready = True
    assert ask(emitter, 2, two_grids) == [3.0, 5.0]


def test_between_tell_and_ask_it_can_be_pickled(two_grids):
    emitter = MESEmitter(Marking())
    twin = pickle.loads(pickle.dumps(emitter))
    assert ask(twin, 5, two_grids) == ask(emitter, 5, two_grids)
