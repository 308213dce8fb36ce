import copy
import pickle

import numpy as np
import pytest

from lqd_search import EmitterError, GridSpec, MultiBDArchive
from lqd_search.emitters.evolution_emitter import EvolutionEmitter
from lqd_search.solution_space import BoxSpace

BOX = BoxSpace([0.0, 0.0], [10.0, 10.0])
STEP = 0.05


def tiny(**options):
    return EvolutionEmitter(BOX, sigma0=STEP, **options)


class Search:
    """An emitter on an archive with one grid, over the first number of the solutions."""

    def __init__(self, emitter, archive, *, seed=0):
        self.emitter, self.archive = emitter, archive
        self.rng = np.random.default_rng(seed)

    def ask(self, n):
        return self.emitter.ask(n, archive=self.archive, rng=self.rng)

    def step(self, n, batch_of):
        """Go on by one generation whose objective is the second number."""
        solutions = self.ask(n)
        info = self.archive.add(
            solution=solutions,
            objective=solutions[:, 1],
            measures=np.repeat(solutions[:, :1], len(self.archive.descriptors), axis=1),
            success=np.zeros(n, bool),
        )
        batch = batch_of(solutions, status=info["status"], value=info["value"])
        self.emitter.tell(batch, archive=self.archive)
        return solutions


@pytest.fixture
def start(archive_of):
    """An archive with the failure [2, 2] and the success [7, 7]."""

    def new(**places):
        solutions = np.array([[2.0, 2.0], [7.0, 7.0]])
        return archive_of(places or {"a": [2, 7]}, success=[0, 1], solutions=solutions)

    return new


def test_strategies_start_at_a_success(start):
    solutions = Search(tiny(), start()).ask(60)
    assert np.abs(solutions - 7.0).max() < 6 * STEP
    assert np.abs(solutions - 7.0).std() > STEP / 2


def test_without_a_success_they_start_at_any_elite(archive_of):
    archive = archive_of({"a": [2]}, success=[0], solutions=np.array([[2.0, 3.0]]))
    solutions = Search(tiny(), archive).ask(12)
    assert np.abs(solutions - [2.0, 3.0]).max() < 6 * STEP


@pytest.mark.parametrize("n", [0, 1, 2, 3, 4, 5, 7, 30])
def test_it_makes_as_many_as_are_asked_for_and_goes_on(start, batch_of, n):
    search = Search(tiny(strategies=3), start())
    for _ in range(4):
        solutions = search.step(n, batch_of)
        assert solutions.shape == (n, 2)
        assert np.array_equal(BOX.repair(solutions), solutions)


def test_another_number_starts_new_strategies(start, batch_of):
    search = Search(tiny(), start())
    for n in (9, 9, 4, 0, 9, 1):
        assert search.step(n, batch_of).shape == (n, 2)


def test_what_leaves_the_space_is_brought_back(archive_of):
    archive = archive_of({"a": [0]}, success=[1], solutions=np.array([[0.0, 10.0]]))
    solutions = Search(EvolutionEmitter(BOX, sigma0=1.0), archive).ask(50)
    assert ((solutions >= 0.0) & (solutions <= 10.0)).all()
    assert (solutions[:, 0] == 0.0).any()


def test_it_follows_improvement(start, batch_of):
    search = Search(EvolutionEmitter(BOX, strategies=1), start())
    heights = [search.step(24, batch_of)[:, 1].mean() for _ in range(20)]
    assert heights[0] < 7.5
    assert max(heights) > 8.5


def test_a_strategy_that_improves_nothing_starts_anew_at_a_success(start, batch_of):
    archive = start()
    search = Search(tiny(strategies=1), archive)
    solutions = search.ask(8)
    # Meanwhile there is a second success, far away, and the first is lost.
    archive.set_grid("a", GridSpec(dims=(10,), ranges=((0.0, 10.0),)))
    archive.add_single([1.0, 9.0], 0.0, [1.0], success=True)
    batch = batch_of(solutions, status=np.zeros(8), value=np.full(8, -1.0))
    search.emitter.tell(batch, archive=archive)
    assert np.abs(search.ask(8) - [1.0, 9.0]).max() < 6 * STEP


def test_what_others_made_moves_no_strategy(start, batch_of):
    one, two = Search(tiny(), start()), Search(tiny(), start())
    for search in (one, two):
        search.step(9, batch_of)
    other = batch_of(np.full((5, 2), 3.0), asked=False)
    one.emitter.tell(other, archive=one.archive)
    assert one.step(9, batch_of).tobytes() == two.step(9, batch_of).tobytes()


def two_places(archive_of):
    """Grid `a` has its success at [7, 7], grid `b` at [1, 1]."""
    return archive_of(
        {"a": [7, None], "b": [None, 1]},
        success=[1, 1],
        solutions=np.array([[7.0, 7.0], [1.0, 1.0]]),
    )


def undefined_somewhere(batch_of, *names, valid=True):
    measures = {name: np.array([[np.nan if name in names else 0.0], [0.0]]) for name in "ab"}
    return batch_of(np.zeros((2, 2)), asked=False, measures=measures, valid=np.array([valid, True]))


def test_only_grids_that_are_always_defined_are_started_on(archive_of, batch_of):
    search = Search(tiny(), two_places(archive_of))
    search.emitter.tell(undefined_somewhere(batch_of, "a"), archive=search.archive)
    assert np.abs(search.ask(12) - 1.0).max() < 6 * STEP


def test_where_none_is_always_defined_any_will_do(archive_of, batch_of):
    search = Search(tiny(strategies=2), two_places(archive_of))
    search.emitter.tell(undefined_somewhere(batch_of, "a", "b"), archive=search.archive)
    solutions = search.ask(12)
    assert np.abs(solutions[:6] - 7.0).max() < 6 * STEP
    assert np.abs(solutions[6:] - 1.0).max() < 6 * STEP


def test_a_motion_that_failed_says_nothing_of_the_descriptors(archive_of, batch_of):
    search = Search(tiny(strategies=1), two_places(archive_of))
    search.emitter.tell(undefined_somewhere(batch_of, "a", valid=False), archive=search.archive)
    assert np.abs(search.ask(6) - 7.0).max() < 6 * STEP


def test_a_batch_of_which_all_is_undefined_is_learned_from(start, batch_of):
    search = Search(tiny(), start())
    for _ in range(3):
        solutions = search.ask(9)
        batch = batch_of(
            solutions,
            status=np.zeros(9),
            value=np.full(9, -np.inf),
            valid=np.zeros(9, bool),
            measures={"a": np.full((9, 1), np.nan)},
        )
        search.emitter.tell(batch, archive=search.archive)
    assert search.ask(9).shape == (9, 2)


@pytest.mark.parametrize("emptied", [False, True])
def test_a_grid_may_disappear_when_the_ranges_are_learned_again(start, batch_of, emptied):
    search = Search(tiny(strategies=1), start(a=[2, 7], b=[2, 7]))
    solutions = search.ask(8)
    if emptied:
        search.archive.set_grid("a", GridSpec(dims=(10,), ranges=((0.0, 10.0),)))
    else:
        search.archive.drop_grid("a")
    batch = batch_of(solutions, status=np.zeros(8), value=np.full(8, -1.0))
    search.emitter.tell(batch, archive=search.archive)
    assert np.abs(search.ask(8) - 7.0).max() < 6 * STEP


def test_huge_improvements_can_be_computed_with(start, batch_of):
    search = Search(tiny(strategies=1), start())
    for value in (np.inf, 1e300, -1e300, -np.inf):
        solutions = search.ask(4)
        values = np.array([value, value, 0.0, 1.0])
        batch = batch_of(solutions, status=[1, 1, 1, 0], value=values)
        search.emitter.tell(batch, archive=search.archive)
    assert np.isfinite(search.ask(4)).all()


@pytest.mark.parametrize("generations", [0, 1, 4])
@pytest.mark.parametrize("twin_of", [copy.deepcopy, lambda s: pickle.loads(pickle.dumps(s))])
def test_a_copy_goes_on_bit_for_bit(start, batch_of, generations, twin_of):
    search = Search(EvolutionEmitter(BOX, sigma0=1.0), start())
    for _ in range(generations):
        search.step(10, batch_of)
    twin = twin_of(search)
    for _ in range(6):
        one, two = (s.step(10, batch_of) for s in (search, twin))
        assert one.tobytes() == two.tobytes()


def test_a_copy_holds_no_solutions_of_the_archive(start, batch_of):
    search = Search(tiny(), start())
    search.step(9, batch_of)
    big = MultiBDArchive(descriptors={"a": 1}, solution_dim=2)
    big.set_grid("a", GridSpec(dims=(5000,), ranges=((0.0, 10.0),)))
    places = np.random.default_rng(0).uniform(0, 10, (5000, 2))
    big.add(places, np.zeros(5000), places[:, :1], success=np.ones(5000, bool))
    before = len(pickle.dumps(search.emitter))
    solutions = search.ask(9)
    search.emitter.tell(batch_of(solutions, status=np.zeros(9)), archive=big)
    assert len(pickle.dumps(search.emitter)) < before + 1000


@pytest.mark.parametrize("options", [{"strategies": 0}, {"sigma0": 0.0}, {"sigma0": np.inf}])
def test_what_makes_no_strategy_is_refused(options):
    with pytest.raises(EmitterError, match="at least 1 strategy and a finite first step size"):
        EvolutionEmitter(BOX, **options)
