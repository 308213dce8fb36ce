import copy
import dataclasses

import numpy as np
import pytest

from lqd_search import (
    ArchiveError,
    DescriptorRanges,
    MultiBDArchive,
    MultiBDScheduler,
    ObservationError,
    ObservationLog,
    SchedulerError,
    Values,
    compete_by_coin,
)

FIELDS = {"evaluation": ((), np.int64), "expert": ((), np.bool_)}
BATCH = 32


def new_scheduler(toy, *, minimum=16, cells=100, seed=0, space=None, emitter=None):
    return MultiBDScheduler(
        MultiBDArchive(descriptors=toy.descriptors, solution_dim=toy.dim, extra_fields=FIELDS),
        space or toy,
        ranges=DescriptorRanges(toy.descriptors, minimum=minimum, cells=cells),
        fitness="near",
        batch_size=BATCH,
        rng=np.random.default_rng(seed),
        emitter=emitter,
    )


def state(scheduler):
    archive = scheduler.archive
    return {
        "specs": dict(archive.specs),
        "clipped": dict(archive.clipped),
        "waiting": scheduler.ranges.waiting,
        "elites": {
            name: {field: c.tolist() for field, c in archive.grid_elites(name).items()}
            for name in archive.grids
        },
    }


def run(scheduler, toy, generations, *, log=None, first=0):
    for generation in range(generations):
        solutions = scheduler.ask()
        values = toy.evaluate(solutions)
        evaluation = first + generation * BATCH + np.arange(BATCH)
        scheduler.tell(solutions, values, evaluation=evaluation)
        if log is not None:
            valid = values.valid
            log.record(evaluation[valid], {n: m[valid] for n, m in values.measures.items()})


def test_the_first_batch_is_random(toy):
    solutions = new_scheduler(toy).ask()
    assert np.array_equal(solutions, toy.sample(BATCH, rng=np.random.default_rng(0)))


def test_while_all_grids_are_empty_batches_are_random(toy):
    scheduler = new_scheduler(toy)
    solutions = scheduler.ask()
    values = toy.evaluate(solutions)
    nothing = dataclasses.replace(
        values, fitness={name: np.full(BATCH, np.nan) for name in values.fitness}
    )
    scheduler.tell(solutions, nothing, evaluation=0)
    assert scheduler.archive.empty
    assert scheduler.archive.grids != {}
    generator = np.random.default_rng(0)
    toy.sample(BATCH, rng=generator)
    assert np.array_equal(scheduler.ask(), toy.sample(BATCH, rng=generator))


class Counting:
    """A space that notes how many parents it was given, and leaves them alone."""

    dim = 3

    def __init__(self, toy):
        self.toy = toy
        self.shares = []

    def sample(self, n, *, rng):
        return self.toy.sample(n, rng=rng)

    def mutate(self, parents, *, rng):  # noqa: ARG002 -- the protocol's
        self.shares.append(len(parents))
        return parents


def test_grids_with_elites_share_the_batch_and_the_first_take_the_rest(toy):
    space = Counting(toy)
    scheduler = new_scheduler(toy, space=space)
    run(scheduler, toy, 1)
    assert list(scheduler.archive.grids) == ["start.place", "start.flag", "end.place"]
    assert scheduler.ask().shape == (BATCH, 3)
    assert space.shares == [11, 11, 10]


def test_another_size_can_be_asked_for(toy):
    space = Counting(toy)
    scheduler = new_scheduler(toy, space=space)
    run(scheduler, toy, 1)
    solutions = scheduler.ask(2)
    assert solutions.shape == (2, 3)
    assert space.shares == [1, 1]
    scheduler.tell(solutions, toy.evaluate(solutions), evaluation=BATCH)


def test_an_empty_grid_leaves_its_share_to_the_others(toy):
    space = Counting(toy)
    scheduler = new_scheduler(toy, space=space)
    run(scheduler, toy, 1)
    scheduler.archive.set_grid("start.flag", scheduler.archive.specs["start.flag"])
    scheduler.ask()
    assert space.shares == [16, 16]


def test_only_valid_solutions_with_a_fitness_are_offered(toy):
    scheduler = new_scheduler(toy)
    solutions = scheduler.ask()
    values = toy.evaluate(solutions)
    near = values.fitness["near"].copy()
    near[::2] = np.nan
    scheduler.tell(
        solutions,
        dataclasses.replace(values, fitness=dict(values.fitness) | {"near": near}),
        evaluation=100,
    )
    kept = set(scheduler.archive.elites().fields["evaluation"].tolist())
    assert kept <= set((100 + np.flatnonzero(values.valid & ~np.isnan(near))).tolist())
    assert kept


def test_passive_columns_travel_with_the_elites(toy):
    scheduler = new_scheduler(toy)
    run(scheduler, toy, 4)
    elites = scheduler.archive.elites().fields
    expected = toy.evaluate(elites["solution"])
    assert elites["expert"].tolist() == expected.passive["expert"].tolist()
    assert elites["success"].tolist() == expected.success.tolist()
    assert elites["objective"].tolist() == expected.fitness["near"].tolist()
    assert elites["expert"].any()


def values_at(places, *, fitness):
    """Values of solutions for descriptors `often` and `rare`; `rare` is None where undefined."""
    n = len(places)
    rare = [np.nan if place is None else place for _, place in places]
    return Values(
        valid=np.ones(n, bool),
        success=np.zeros(n, bool),
        fitness={"f": np.array(fitness, float)},
        measures={
            "often": np.array([[often] for often, _ in places], float),
            "rare": np.array(rare, float)[:, None],
        },
    )


def two_descriptors(toy, *, minimum, emitter=None, fields=None):
    lengths = {"often": 1, "rare": 1}
    archive = MultiBDArchive(
        descriptors=lengths,
        solution_dim=1,
        extra_fields={"evaluation": ((), np.int64), **(fields or {})},
    )
    return MultiBDScheduler(
        archive,
        toy,
        ranges=DescriptorRanges(lengths, minimum=minimum, cells=10),
        fitness="f",
        batch_size=2,
        rng=np.random.default_rng(0),
        emitter=emitter,
    )


def inject(scheduler, values, *, first):
    solutions = first + np.arange(len(values), dtype=float)[:, None]
    scheduler.inject(solutions, values, evaluation=first)


def rare_elites(scheduler):
    elites = scheduler.archive.grid_elites("rare")
    return dict(zip(elites["evaluation"].tolist(), elites["measures"][:, 0].tolist(), strict=True))


def test_solutions_are_kept_aside_until_their_range_is_known(toy):
    scheduler = two_descriptors(toy, minimum=3)
    # Evaluation 0 loses its cell of `often` to 1, and must still get its cell of `rare`.
    inject(scheduler, values_at([(1, 10), (1, None), (2, None)], fitness=[0, 5, 0]), first=0)
    assert scheduler.ranges.waiting == ("rare",)
    assert scheduler.archive.elites().fields["evaluation"].tolist() == [1, 2]
    inject(scheduler, values_at([(3, 20)], fitness=[0]), first=3)
    assert scheduler.ranges.waiting == ("rare",)
    inject(scheduler, values_at([(1, 30), (1, 10)], fitness=[0, 0]), first=4)
    assert scheduler.ranges.waiting == ()
    # Evaluation 5 ties with 0, which was kept aside and therefore came first.
    assert rare_elites(scheduler) == {0: 10.0, 3: 20.0, 4: 30.0}
    assert scheduler.archive.specs["rare"].ranges[0] == pytest.approx((9.0, 31.0))
    inject(scheduler, values_at([(1, 40)], fitness=[-1]), first=6)
    assert scheduler.archive.clipped["rare"] == 1
    assert rare_elites(scheduler) == {0: 10.0, 3: 20.0, 4: 30.0}


def test_values_of_solutions_without_fitness_count_for_the_range_only(toy):
    scheduler = two_descriptors(toy, minimum=3)
    inject(scheduler, values_at([(1, 10), (2, 20), (3, 30)], fitness=[np.nan, 0, np.nan]), first=0)
    assert scheduler.archive.specs["rare"].ranges[0] == pytest.approx((9.0, 31.0))
    assert rare_elites(scheduler) == {1: 20.0}


def test_solutions_that_are_not_valid_count_for_nothing(toy):
    scheduler = two_descriptors(toy, minimum=3)
    values = values_at([(1, 10), (2, 20), (3, 30), (9, 90)], fitness=[0, 0, 0, 9])
    inject(
        scheduler, dataclasses.replace(values, valid=np.array([True, True, True, False])), first=0
    )
    assert scheduler.archive.specs["rare"].ranges[0] == pytest.approx((9.0, 31.0))
    assert rare_elites(scheduler) == {0: 10.0, 1: 20.0, 2: 30.0}


def test_relearning_rebuilds_the_grids_from_everything_observed(toy):
    scheduler = new_scheduler(toy)
    log = ObservationLog(toy.descriptors)
    run(scheduler, toy, 6, log=log)
    before = scheduler.archive.elites()
    scheduler.relearn_ranges(log)
    assert scheduler.ranges.specs["start.place"].ranges[0] == (
        learned_range(log.defined("start.place")[:, 0])
    )
    after = scheduler.archive.elites().fields
    assert set(after["evaluation"]) <= set(before.fields["evaluation"])
    assert scheduler.archive.clipped == dict.fromkeys(scheduler.archive.grids, 0)
    for name in scheduler.archive.grids:
        elites = scheduler.archive.grid_elites(name)
        expected = toy.evaluate(elites["solution"]).measures[name]
        assert elites["measures"].tolist() == expected.tolist()
    # Every elite was offered to every grid, so its cells are taken, by itself or by another.
    grid = scheduler.archive.grids["start.place"]
    place = toy.evaluate(before.fields["solution"]).measures["start.place"]
    assert grid.retrieve(place)[0].all()


def learned_range(column):
    padding = 0.05 * (column.max() - column.min())
    return (column.min() - padding, column.max() + padding)


def test_relearning_fills_a_grid_that_waited_from_what_was_kept_aside(toy):
    scheduler = two_descriptors(toy, minimum=3)
    first = values_at([(1, 10), (1, None), (2, 20)], fitness=[0, 5, 0])
    inject(scheduler, first, first=0)
    log = ObservationLog({"often": 1, "rare": 1})
    log.record(np.arange(3), first.measures)
    # Another run saw a third value; its solution is not in this archive.
    log.record(np.array([50]), values_at([(9, 50)], fitness=[0]).measures)
    scheduler.relearn_ranges(log)
    assert scheduler.ranges.waiting == ()
    assert scheduler.archive.specs["rare"].ranges[0] == pytest.approx((8.0, 52.0))
    assert rare_elites(scheduler) == {0: 10.0, 2: 20.0}


def test_after_relearning_a_descriptor_may_still_wait(toy):
    scheduler = two_descriptors(toy, minimum=3)
    first = values_at([(1, 10), (1, None), (2, None)], fitness=[0, 5, 0])
    inject(scheduler, first, first=0)
    log = ObservationLog({"often": 1, "rare": 1})
    log.record(np.arange(3), first.measures)
    log.record(np.array([50]), values_at([(9, 50)], fitness=[0]).measures)
    scheduler.relearn_ranges(log)
    assert scheduler.ranges.waiting == ("rare",)
    inject(scheduler, values_at([(4, 30)], fitness=[0]), first=60)
    assert scheduler.archive.specs["rare"].ranges[0] == pytest.approx((8.0, 52.0))
    assert rare_elites(scheduler) == {0: 10.0, 60: 30.0}


def test_a_descriptor_that_never_has_enough_values_leaves_an_empty_archive(toy):
    scheduler = two_descriptors(toy, minimum=9)
    first = values_at([(1, 10)], fitness=[0])
    inject(scheduler, first, first=0)
    log = ObservationLog({"often": 1, "rare": 1})
    log.record(np.arange(1), first.measures)
    scheduler.relearn_ranges(log)
    assert scheduler.archive.empty
    assert scheduler.ranges.waiting == ("often", "rare")


def test_relearning_needs_every_elite_in_the_log(toy):
    scheduler = new_scheduler(toy)
    run(scheduler, toy, 1)
    before = state(scheduler)
    with pytest.raises(
        ObservationError,
        match=r"Expected evaluations that were recorded, but \d+ is none of the 0 in",
    ):
        scheduler.relearn_ranges(ObservationLog(toy.descriptors))
    assert state(scheduler) == before


def without(mapping, name):
    return {key: value for key, value in mapping.items() if key != name}


def narrow(mapping):
    return dict(mapping) | {"end.place": mapping["end.place"][:, :2]}


@pytest.mark.parametrize(
    ("spoil", "error", "message"),
    [
        (
            lambda v: {"fitness": without(v.fitness, "near")},
            SchedulerError,
            "fitness 'near' among the values, but there are only flat, away",
        ),
        (
            lambda v: {"measures": without(v.measures, "rare.place")},
            SchedulerError,
            "measures 'rare.place' among the values",
        ),
        (lambda v: {"measures": narrow(v.measures)}, SchedulerError, "3 measures of descriptor"),
        (
            lambda _: {"passive": {}},
            SchedulerError,
            "passive column 'expert' among the values, but there are only none",
        ),
        (
            lambda v: {"passive": {"expert": np.zeros(len(v))}},
            ArchiveError,
            "expert to have dtype bool",
        ),
    ],
)
def test_values_that_do_not_fit_change_nothing(toy, spoil, error, message):
    scheduler, twin = new_scheduler(toy), new_scheduler(toy)
    run(scheduler, toy, 2)
    run(twin, toy, 2)
    before = state(scheduler)
    solutions = scheduler.ask()
    values = toy.evaluate(solutions)
    with pytest.raises(error, match=message):
        scheduler.tell(solutions, dataclasses.replace(values, **spoil(values)), evaluation=64)
    assert state(scheduler) == before
    scheduler.tell(solutions, values, evaluation=64)
    run(scheduler, toy, 1, first=96)
    run(twin, toy, 2, first=64)
    assert state(scheduler) == state(twin)


def test_wrong_lengths_change_nothing(toy):
    scheduler = new_scheduler(toy)
    run(scheduler, toy, 1)
    before = state(scheduler)
    solutions = scheduler.ask()
    values = toy.evaluate(solutions)
    with pytest.raises(SchedulerError, match="the 32 solutions asked for, but got 31; tell all"):
        scheduler.tell(solutions[1:], values, evaluation=32)
    with pytest.raises(SchedulerError, match="values of 32 solutions, but got 31"):
        scheduler.tell(solutions, toy.evaluate(solutions[1:]), evaluation=32)
    with pytest.raises(SchedulerError, match=r"one evaluation id, or 32 of them.*\(31,\)"):
        scheduler.tell(solutions, values, evaluation=np.arange(31))
    with pytest.raises(ArchiveError, match=r"solution to have shape \(\d+, 3\)"):
        scheduler.tell(solutions[:, :2], values, evaluation=32)
    assert state(scheduler) == before
    scheduler.tell(solutions, values, evaluation=32)
    assert state(scheduler) != before


def test_a_grid_that_fails_in_the_middle_of_tell_changes_nothing(toy, monkeypatch):
    scheduler, twin = new_scheduler(toy), new_scheduler(toy)
    run(scheduler, toy, 2)
    run(twin, toy, 2)
    before = state(scheduler)
    solutions = scheduler.ask()
    values = toy.evaluate(solutions)

    def fail(**_):
        raise OSError("no space left in this grid")

    monkeypatch.setattr(scheduler.archive.grids["start.flag"], "add", fail)
    with pytest.raises(OSError, match="no space"):
        scheduler.tell(solutions, values, evaluation=64)
    assert state(scheduler) == before
    scheduler.tell(solutions, values, evaluation=64)
    run(scheduler, toy, 1, first=96)
    run(twin, toy, 2, first=64)
    assert state(scheduler) == state(twin)


def test_an_error_in_the_middle_of_tell_takes_no_coin(toy, monkeypatch):
    def tossing():
        scheduler = new_scheduler(toy, cells=4)
        scheduler.archive = MultiBDArchive(
            descriptors=toy.descriptors,
            solution_dim=toy.dim,
            extra_fields=FIELDS,
            competition=compete_by_coin(np.random.default_rng(6)),
        )
        return scheduler

    scheduler, twin = tossing(), tossing()
    run(scheduler, toy, 2)
    run(twin, toy, 2)
    solutions = scheduler.ask()
    values = toy.evaluate(solutions)

    def fail(**_):
        raise OSError("no space left in this grid")

    monkeypatch.setattr(scheduler.archive.grids["start.flag"], "add", fail)
    with pytest.raises(OSError, match="no space"):
        scheduler.tell(solutions, values, evaluation=64)
    scheduler.tell(solutions, values, evaluation=64)
    run(scheduler, toy, 3, first=96)
    run(twin, toy, 4, first=64)
    assert state(scheduler) == state(twin)


def test_it_is_empty_until_it_holds_a_solution_in_a_grid_or_aside(toy):
    scheduler = two_descriptors(toy, minimum=3)
    assert scheduler.empty
    inject(scheduler, values_at([(1, 10)], fitness=[np.nan]), first=0)
    assert scheduler.empty
    inject(scheduler, values_at([(2, None)], fitness=[0]), first=1)
    assert scheduler.archive.empty
    assert not scheduler.empty
    inject(scheduler, values_at([(3, None)], fitness=[0]), first=2)
    assert not scheduler.archive.empty
    assert not scheduler.empty


def test_a_range_learned_in_a_tell_that_fails_is_forgotten(toy, monkeypatch):
    scheduler = two_descriptors(toy, minimum=3)
    inject(scheduler, values_at([(1, 10), (2, 20), (3, None)], fitness=[0, 0, 0]), first=0)
    before = state(scheduler)

    def fail(**_):
        raise OSError("no space left in this grid")

    monkeypatch.setattr(scheduler.archive.grids["often"], "add", fail)
    with pytest.raises(OSError, match="no space"):
        inject(scheduler, values_at([(4, 30)], fitness=[9]), first=3)
    assert state(scheduler) == before
    assert scheduler.ranges.waiting == ("rare",)
    inject(scheduler, values_at([(4, 30)], fitness=[9]), first=3)
    assert rare_elites(scheduler) == {0: 10.0, 1: 20.0, 3: 30.0}


def test_ask_and_tell_take_turns(toy):
    scheduler = new_scheduler(toy)
    with pytest.raises(SchedulerError, match="a call of ask before tell; to tell more, use inject"):
        scheduler.tell(np.zeros((1, 3)), toy.evaluate(np.zeros((1, 3))), evaluation=0)
    scheduler.ask()
    with pytest.raises(SchedulerError, match="values of the 32 solutions asked for last"):
        scheduler.ask()


def test_the_archive_must_fit(toy):
    def new(descriptors, fields):
        return MultiBDScheduler(
            MultiBDArchive(descriptors=descriptors, solution_dim=3, extra_fields=fields),
            toy,
            ranges=DescriptorRanges({"a": 1, "b": 2}),
            fitness="near",
            batch_size=4,
            rng=np.random.default_rng(0),
        )

    with pytest.raises(SchedulerError, match="the extra field 'evaluation', but it has solution"):
        new({"a": 1, "b": 2}, {})
    with pytest.raises(SchedulerError, match=r"archive's descriptors, \{'b': 2, 'a': 1\}"):
        new({"b": 2, "a": 1}, FIELDS)


def test_ranges_that_are_known_beforehand_make_grids(toy):
    learner = new_scheduler(toy)
    run(learner, toy, 1)
    archive = MultiBDArchive(descriptors=toy.descriptors, solution_dim=3, extra_fields=FIELDS)
    MultiBDScheduler(
        archive,
        toy,
        ranges=learner.ranges,
        fitness="near",
        batch_size=4,
        rng=np.random.default_rng(0),
    )
    assert archive.specs == learner.archive.specs


def test_the_same_seed_gives_the_same_run(toy):
    one, two, other = (new_scheduler(toy, seed=seed) for seed in (4, 4, 5))
    for scheduler in (one, two, other):
        run(scheduler, toy, 4)
    assert state(one) == state(two)
    assert state(one) != state(other)


def test_the_archive_fills_and_finds_successes(toy):
    scheduler = new_scheduler(toy, cells=10_000)
    run(scheduler, toy, 15)
    random = toy.evaluate(toy.sample(15 * BATCH, rng=np.random.default_rng(0)))
    assert scheduler.archive.elites().successes > 2 * random.success.sum() > 0


class Noting:
    """An emitter that makes zeros, and notes what it is asked and told."""

    def __init__(self, dim):
        self.dim = dim
        self.asked = []
        self.told = []

    def ask(self, n, *, archive, rng):  # noqa: ARG002 -- the protocol's
        assert not archive.empty
        self.asked.append(n)
        return np.zeros((n, self.dim))

    def tell(self, batch, *, archive):
        self.told.append((batch, len(archive)))


def test_the_emitter_is_asked_as_soon_as_there_is_an_elite_and_told_of_everything(toy):
    emitter = Noting(3)
    scheduler = new_scheduler(toy, emitter=emitter)
    run(scheduler, toy, 1)
    assert emitter.asked == []
    assert not emitter.told[0][0].asked
    run(scheduler, toy, 2, first=BATCH)
    scheduler.inject(np.ones((3, 3)), toy.evaluate(np.ones((3, 3))), evaluation=99)
    assert emitter.asked == [BATCH, BATCH]
    assert [batch.asked for batch, _ in emitter.told] == [False, True, True, False]
    assert [len(batch) for batch, _ in emitter.told] == [BATCH] * 3 + [3]
    # When it is told of a batch, the archive holds it already.
    assert all(size > 0 for _, size in emitter.told)


def test_a_batch_asked_of_the_emitter_stays_its_own_whatever_is_injected_before_it(toy):
    emitter = Noting(3)
    scheduler = new_scheduler(toy, emitter=emitter)
    run(scheduler, toy, 1)
    solutions = scheduler.ask()
    scheduler.inject(np.ones((3, 3)), toy.evaluate(np.ones((3, 3))), evaluation=50)
    scheduler.tell(solutions, toy.evaluate(solutions), evaluation=60)
    assert [batch.asked for batch, _ in emitter.told] == [False, False, True]


def test_the_emitter_is_told_the_status_and_value_of_each_solution(toy):
    emitter = Noting(1)
    scheduler = two_descriptors(toy, minimum=1, emitter=emitter)
    first = values_at([(1, None), (9, None)], fitness=[0, 0])
    inject(scheduler, first, first=0)
    batch, _ = emitter.told[-1]
    assert (batch.status.tolist(), batch.value.tolist()) == ([2, 2], [0.0, 0.0])
    values = values_at(
        [(1, None), (9, None), (1, None), (5, None), (5, None)], fitness=[3, -1, 9, np.nan, 7]
    )
    valid = np.array([True, True, False, True, True])
    inject(scheduler, dataclasses.replace(values, valid=valid), first=2)
    batch, _ = emitter.told[-1]
    # Better, worse, failed before it was judged, without a fitness, and the first in its cell.
    assert batch.status.tolist() == [1, 0, 0, 0, 2]
    assert batch.value.tolist() == [3.0, -1.0, -np.inf, -np.inf, 7.0]
    assert batch.objective[[0, 1, 2, 4]].tolist() == [3.0, -1.0, 9.0, 7.0]
    assert batch.solutions[:, 0].tolist() == [2.0, 3.0, 4.0, 5.0, 6.0]
    assert batch.found.tolist() == [False] * 5


def test_what_was_kept_aside_is_not_mixed_up_with_the_batch(toy):
    emitter = Noting(1)
    scheduler = two_descriptors(toy, minimum=3, emitter=emitter)
    # Of the first batch 0 and 1 wait for the range of `rare`.
    inject(scheduler, values_at([(1, 10), (5, 20), (9, None)], fitness=[5, 6, 7]), first=0)
    inject(scheduler, values_at([(1, 10), (1, 30)], fitness=[0, 1]), first=3)
    batch, _ = emitter.told[-1]
    assert batch.solutions[:, 0].tolist() == [3.0, 4.0]
    # Evaluation 3 meets 0 in both grids, as it was kept aside; 4 is the first in its cell.
    assert rare_elites(scheduler) == {0: 10.0, 1: 20.0, 4: 30.0}
    assert batch.status.tolist() == [0, 2]
    assert batch.value.tolist() == [0.0, 1.0]


def test_a_batch_of_which_nothing_is_offered_is_told_all_the_same(toy):
    emitter = Noting(1)
    scheduler = two_descriptors(toy, minimum=1, emitter=emitter)
    inject(scheduler, values_at([(1, None), (9, None)], fitness=[np.nan, np.nan]), first=0)
    batch, _ = emitter.told[-1]
    assert (batch.status.tolist(), batch.value.tolist()) == ([0, 0], [-np.inf, -np.inf])


@pytest.mark.parametrize("where", ["add", "check", "names"])
def test_of_a_batch_that_failed_the_emitter_is_told_nothing(toy, monkeypatch, where):
    emitter = Noting(3)
    scheduler = new_scheduler(toy, emitter=emitter)
    run(scheduler, toy, 1)
    solutions = scheduler.ask()
    values = toy.evaluate(solutions)

    def fail(*_, **__):
        raise MemoryError("in the archive")

    spoilt = {"check": {"passive": {"expert": np.zeros(BATCH)}}, "names": {"measures": {}}}
    wrong = dataclasses.replace(values, **spoilt.get(where, {}))
    with monkeypatch.context() as patch:
        if where == "add":
            patch.setattr(scheduler.archive, "add", fail)
        with pytest.raises((MemoryError, SchedulerError, ArchiveError)):
            scheduler.tell(solutions, wrong, evaluation=BATCH)
    assert len(emitter.told) == 1
    scheduler.tell(solutions, values, evaluation=BATCH)
    assert emitter.told[-1][0].asked


def test_a_field_may_be_a_perceived_column(toy):
    scheduler = two_descriptors(toy, minimum=1, fields={"touch": ((2,), np.float64)})
    touch = np.array([[1.0, 2.0], [3.0, 4.0]])
    values = values_at([(1, None), (9, None)], fitness=[0, 0])
    with pytest.raises(SchedulerError, match="passive column 'touch' among the values"):
        inject(scheduler, values, first=0)
    inject(scheduler, dataclasses.replace(values, perceived={"touch": touch}), first=0)
    assert scheduler.archive.elites().fields["touch"].tolist() == touch.tolist()


def test_no_emitter_sees_the_passive_columns_of_the_values(toy):
    emitter = Noting(3)
    run(new_scheduler(toy, emitter=emitter), toy, 2)
    assert [batch.values.passive for batch, _ in emitter.told] == [{}, {}]


class Failing(Noting):
    """An emitter that cannot learn from what it is asked for."""

    def tell(self, batch, *, archive):
        super().tell(batch, archive=archive)
        if batch.asked:
            raise OSError("out of ideas")


@pytest.mark.parametrize("copied", [lambda scheduler: scheduler, copy.deepcopy])
def test_after_an_emitter_failed_every_call_is_refused(toy, copied):
    scheduler = new_scheduler(toy, emitter=Failing(3))
    run(scheduler, toy, 1)
    solutions = scheduler.ask()
    values = toy.evaluate(solutions)
    with pytest.raises(OSError, match="out of ideas"):
        scheduler.tell(solutions, values, evaluation=BATCH)
    scheduler = copied(scheduler)
    before = state(scheduler)
    for call in (
        lambda: scheduler.tell(solutions, values, evaluation=BATCH),
        lambda: scheduler.inject(solutions, values, evaluation=BATCH),
        scheduler.ask,
    ):
        with pytest.raises(SchedulerError, match=r"since the emitter failed on the last .* go on"):
            call()
    assert state(scheduler) == before


def test_a_scheduler_that_was_kept_before_failures_were_noted_goes_on(toy):
    scheduler = new_scheduler(toy)
    run(scheduler, toy, 1)
    del scheduler.__dict__["_failed"]
    run(scheduler, toy, 1, first=BATCH)
    assert not scheduler.empty


def test_fewer_than_no_solutions_cannot_be_asked_for(toy):
    scheduler = new_scheduler(toy)
    with pytest.raises(SchedulerError, match="asked for 0 or more solutions, but got -3; ask for"):
        scheduler.ask(-3)
    assert scheduler.ask(0).shape == (0, 3)
