import dataclasses
import hashlib
import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lqd_search import (
    ArchiveError,
    BudgetError,
    LanguageDrivenQD,
    MESEmitter,
    MethodError,
    MultiBDArchive,
    SchedulerError,
    compete_by_coin,
)
from lqd_search.emitters.screen import NeighbourScreen
from lqd_search.emitters.shares import CreditedShares

PASSIVE = {"expert": ((), np.bool_)}


def new_method(toy, *, evaluations=640, batch_size=32, seed=0, names=None, **options):
    options = {"passive_fields": PASSIVE, "minimum": 16, "cells": 400} | options
    return LanguageDrivenQD(
        toy,
        descriptors=toy.descriptors,
        fitness_names=names or toy.fitness_names,
        evaluations=evaluations,
        batch_size=batch_size,
        rng=np.random.default_rng(seed),
        **options,
    )


def step(method, toy):
    """Go on by one generation and return its solutions."""
    solutions = method.ask()
    method.tell(toy.evaluate(solutions))
    return solutions


def finish(method, toy):
    """Go on until all is done, and return the generations' stages and solutions."""
    history = []
    while not method.done:
        stage = method.stage
        history.append((stage, step(method, toy)))
    return history


def state(method):
    archive = method.archive
    return {
        "specs": dict(archive.specs),
        "clipped": dict(archive.clipped),
        "exploration": dict(method.exploration),
        "chosen": method.chosen,
        "evaluations": method.evaluations,
        "elites": {
            name: {field: c.tolist() for field, c in archive.grid_elites(name).items()}
            for name in archive.grids
        },
    }


def test_the_stages_of_a_run(toy):
    # A tenth of 960 are 3 generations of 32: the shared one, then 2 for each fitness.
    method = new_method(toy, evaluations=960)
    history = finish(method, toy)
    assert [stage for stage, _ in history] == (
        ["first batch"]
        + ["exploring flat (1 of 3)"] * 2
        + ["exploring near (2 of 3)"] * 2
        + ["exploring away (3 of 3)"] * 2
        + [f"continuing with {method.chosen}"] * 23
    )
    assert {len(solutions) for _, solutions in history} == {32}


@given(
    batch_size=st.integers(1, 24),
    generations=st.integers(20, 45),
    rest=st.integers(0, 23),
    runs=st.integers(1, 3),
)
@settings(max_examples=25, deadline=None)
def test_exactly_the_budget_is_spent(toy, batch_size, generations, rest, runs):
    evaluations = batch_size * generations + rest % batch_size
    method = new_method(
        toy, evaluations=evaluations, batch_size=batch_size, names=toy.fitness_names[:runs]
    )
    history = finish(method, toy)
    sizes = [len(solutions) for _, solutions in history]
    short = generations // 10
    explored = [stage for stage, _ in history if not stage.startswith("continuing")]
    assert sum(sizes) == evaluations == method.evaluations
    assert set(sizes[:-1]) == {batch_size}
    assert len(explored) == 1 + runs * (short - 1)
    with pytest.raises(MethodError, match="since all evaluations are spent"):
        method.ask()


def test_the_first_batch_is_told_to_every_short_run(toy):
    method = new_method(toy, evaluations=960)
    first = step(method, toy)
    after_first = state(method)
    for _ in range(2):
        step(method, toy)
    assert method.stage == "exploring near (2 of 3)"
    # The second run has seen the first batch, and nothing of the first run.
    near = method.archive
    assert near.elites().fields["evaluation"].max() < len(first)
    assert near.specs == after_first["specs"]
    objective = dict(zip(*map(near.elites().fields.get, ("evaluation", "objective")), strict=True))
    values = toy.evaluate(first)
    assert objective
    assert all(values.fitness["near"][i] == value for i, value in objective.items())


def test_short_runs_do_not_depend_on_each_other(toy):
    def second_run(other):
        method = new_method(toy, evaluations=960, names=(other, "near"))
        step(method, toy)
        for _ in range(2):
            step(method, toy)
        assert method.stage == "exploring near (2 of 2)"
        return [step(method, toy).tolist() for _ in range(2)]

    assert second_run("flat") == second_run("away")


def test_coins_of_the_short_runs_do_not_depend_on_each_other(toy):
    def second_run(*, first_inserts):
        competition = compete_by_coin(np.random.default_rng(8))
        # In few cells many failures meet.
        method = new_method(
            toy, evaluations=960, names=("flat", "near"), competition=competition, cells=4
        )
        asked = []
        for _ in range(5):
            asked.append(method.ask())
            values = toy.evaluate(asked[-1])
            flat = values.fitness["flat"] if first_inserts else np.full(32, np.nan)
            fitness = {"flat": flat, "near": values.fitness["near"]}
            method.tell(dataclasses.replace(values, fitness=fitness))
        return np.stack(asked[3:])

    assert np.array_equal(second_run(first_inserts=True), second_run(first_inserts=False))


def test_the_fitness_with_the_most_distinct_successes_is_kept(toy):
    method = new_method(toy, evaluations=960)
    while method.chosen is None:
        assert method.exploration == {}
        lucky = method.stage == "exploring near (2 of 3)"
        values = toy.evaluate(method.ask())
        method.tell(dataclasses.replace(values, success=values.valid & lucky))
    assert list(method.exploration) == ["flat", "near", "away"]
    flat, near, away = method.exploration.values()
    assert (flat, away) == (0, 0)
    assert near > 0
    assert method.chosen == "near"
    assert method.archive.elites().successes > 0


def test_what_is_counted_are_the_distinct_successes_of_each_archive(toy):
    method = new_method(toy, evaluations=960)
    ends = {}
    while method.chosen is None:
        name, archive = method.stage.split()[1], method.archive
        step(method, toy)
        ends[name] = archive.elites()
    ends.pop("batch")
    counted = {
        name: len(np.unique(e.fields["solution"][e.fields["success"]], axis=0))
        for name, e in ends.items()
    }
    assert method.exploration == counted
    assert all(counted.values())


def test_a_tie_goes_to_the_earlier_fitness(toy):
    def without_success(solutions):
        return dataclasses.replace(toy.evaluate(solutions), success=np.zeros(len(solutions), bool))

    method = new_method(toy, names=("away", "near", "flat"))
    while not method.done:
        method.tell(without_success(method.ask()))
    assert method.exploration == {"away": 0, "near": 0, "flat": 0}
    assert method.chosen == "away"


def without_numbers(toy, solutions, *names):
    """Values without a success, and in which these fitness functions give no number."""
    values = toy.evaluate(solutions)
    nothing = np.full(len(solutions), np.nan)
    return dataclasses.replace(
        values,
        success=np.zeros(len(solutions), bool),
        fitness={n: nothing if n in names else f for n, f in values.fitness.items()},
    )


@pytest.mark.parametrize(("dead", "chosen"), [(("flat",), "near"), (("flat", "near"), "away")])
def test_a_fitness_that_never_gives_a_number_is_not_kept(toy, dead, chosen):
    method = new_method(toy, evaluations=960)
    while not method.done:
        method.tell(without_numbers(toy, method.ask(), *dead))
    assert method.exploration == {"flat": 0, "near": 0, "away": 0}
    assert method.chosen == chosen
    assert len(method.output()["solution"]) > 0


def test_where_no_fitness_gives_a_number_the_first_is_kept(toy):
    method = new_method(toy, evaluations=960)
    while not method.done:
        method.tell(without_numbers(toy, method.ask(), "flat", "near", "away"))
    assert method.chosen == "flat"
    assert len(method.output()["solution"]) == 0


def test_solutions_kept_aside_keep_a_run_in_the_choice(toy):
    # With this minimum no descriptor gets a grid before the ranges are learned again.
    method = new_method(toy, evaluations=960, minimum=10_000)
    while method.chosen is None:
        method.tell(without_numbers(toy, method.ask(), "flat"))
    assert method.archive.empty
    assert method.chosen == "near"


@pytest.mark.parametrize("coin", [False, True])
def test_an_error_in_the_choice_leaves_nothing_half_changed(toy, monkeypatch, coin):
    def new():
        options = {"competition": compete_by_coin(np.random.default_rng(3))} if coin else {}
        method = new_method(toy, evaluations=960, cells=16, **options)
        for _ in range(6):
            step(method, toy)
        return method

    method, twin = new(), new()
    values = toy.evaluate(method.ask())
    before = state(method), method.stage

    def fail(*_):
        raise MemoryError("while the grids were rebuilt")

    with monkeypatch.context() as patch:
        patch.setattr(MultiBDArchive, "emptied", fail)
        with pytest.raises(MemoryError, match="rebuilt"):
            method.tell(values)
    assert (state(method), method.stage) == before
    method.tell(values)
    step(twin, toy)
    assert method.chosen is not None
    assert state(method) == state(twin)
    finish(method, toy)
    finish(twin, toy)
    assert state(method) == state(twin)


def test_ranges_are_learned_again_once_and_then_fixed(toy):
    method = new_method(toy, evaluations=960)
    seen, specs = [], []
    while not method.done:
        solutions = step(method, toy)
        if len(specs) == 0 or method.chosen is None or not specs[-1][0]:
            values = toy.evaluate(solutions)
            seen.append(values.measures["start.place"][values.valid])
        specs.append((method.chosen is not None, method.archive.specs["start.place"]))
    early = {spec for chosen, spec in specs if not chosen}
    late = {spec for chosen, spec in specs if chosen}
    assert len(early) == len(late) == 1
    assert early != late
    values = np.concatenate(seen)
    lower, upper = values.min(axis=0), values.max(axis=0)
    padding = 0.05 * (upper - lower)
    assert np.array(late.pop().ranges) == pytest.approx(
        np.stack([lower - padding, upper + padding], axis=1)
    )


def test_a_rare_descriptor_gets_its_grid_when_it_has_enough_values(toy):
    method = new_method(toy, evaluations=1280, minimum=40)
    waiting = []
    while not method.done:
        step(method, toy)
        waiting.append("rare.place" not in method.archive.specs)
    assert waiting[0]
    assert not waiting[-1]


def test_the_output_is_the_union_of_the_elites(toy):
    method = new_method(toy)
    assert len(method.output()["solution"]) == 0
    finish(method, toy)
    output = method.output()
    expected = toy.evaluate(output["solution"])
    assert output["success"].tolist() == expected.success.tolist()
    assert output["objective"].tolist() == expected.fitness[method.chosen].tolist()
    assert output["expert"].tolist() == expected.passive["expert"].tolist()
    assert (np.diff(output["evaluation"]) > 0).all()
    assert isinstance(method.archive, MultiBDArchive)


def test_evaluations_number_the_solutions_as_they_were_asked_for(toy):
    method = new_method(toy)
    asked = np.concatenate([solutions for _, solutions in finish(method, toy)])
    output = method.output()
    assert asked[output["evaluation"]].tolist() == output["solution"].tolist()


def test_the_same_seed_gives_the_same_run_and_another_one_another(toy):
    one, two, other = (new_method(toy, seed=seed) for seed in (1, 1, 2))
    for method in (one, two, other):
        finish(method, toy)
    assert state(one) == state(two)
    assert state(one) != state(other)


@pytest.mark.parametrize("coin", [False, True])
@pytest.mark.parametrize("generations", [0, 1, 2, 6, 7, 20])
def test_pickled_in_the_middle_it_goes_on_bit_for_bit(toy, generations, coin):
    options = {"competition": compete_by_coin(np.random.default_rng(3))} if coin else {}
    method = new_method(toy, evaluations=969, **options)
    for _ in range(generations):
        step(method, toy)
    twin = pickle.loads(pickle.dumps(method))
    assert [s.tobytes() for _, s in finish(method, toy)] == [
        s.tobytes() for _, s in finish(twin, toy)
    ]
    assert state(method) == state(twin)


@pytest.mark.parametrize("generations", [0, 1, 20])
def test_after_an_error_in_tell_it_can_be_told_again(toy, generations):
    method, twin = new_method(toy, evaluations=960), new_method(toy, evaluations=960)
    for _ in range(generations):
        step(method, toy)
        step(twin, toy)
    values = toy.evaluate(method.ask())
    before = state(method)
    with pytest.raises(SchedulerError, match="but got 31"):
        method.tell(toy.evaluate(np.zeros((31, 3))))
    # The first of the short runs takes a first batch without the others' fitness.
    flat_only = {"flat": values.fitness["flat"]} if generations == 0 else {}
    with pytest.raises(SchedulerError, match="Expected the fitness '"):
        method.tell(dataclasses.replace(values, fitness=flat_only))
    with pytest.raises(ArchiveError, match="expert to have dtype bool"):
        method.tell(dataclasses.replace(values, passive={"expert": np.zeros(32)}))
    assert state(method) == before
    method.tell(values)
    finish(method, toy)
    finish(twin, toy)
    assert state(method) == state(twin)


def test_what_was_handed_out_can_be_changed_without_harm(toy):
    method, twin = new_method(toy), new_method(toy)
    while not method.done:
        solutions = method.ask()
        values = toy.evaluate(solutions)
        solutions[:] = 0.0
        method.tell(values)
    finish(twin, toy)
    assert state(method) == state(twin)


def test_ask_and_tell_take_turns(toy):
    method = new_method(toy)
    with pytest.raises(MethodError, match="Expected a call of ask before tell"):
        method.tell(toy.evaluate(np.zeros((32, 3))))
    method.ask()
    with pytest.raises(MethodError, match="since the last ones were not told yet"):
        method.ask()


def test_a_budget_or_names_without_sense_are_refused(toy):
    with pytest.raises(BudgetError, match="use a batch size of at most 32"):
        new_method(toy, evaluations=640, batch_size=33)
    with pytest.raises(MethodError, match="different names, but got near, near; name each once"):
        new_method(toy, names=("near", "near"))


def test_more_successes_than_at_random(toy):
    method = new_method(toy, evaluations=1280, cells=10_000)
    finish(method, toy)
    random = toy.evaluate(toy.sample(1280, rng=np.random.default_rng(0)))
    assert method.output()["success"].sum() > 2 * random.success.sum() > 0


def fingerprint(method):
    """A hash of who holds which cell; integers only, so that it is the same everywhere."""
    digest = hashlib.sha256()
    for name in method.archive.grids:
        elites = method.archive.grid_elites(name)
        for field in ("index", "evaluation", "success"):
            digest.update(elites[field].astype("<i8").tobytes())
    return digest.hexdigest()[:16]


def test_a_small_run_comes_out_as_ever(toy):
    method = new_method(toy, evaluations=1289, seed=7)
    finish(method, toy)
    output = method.output()
    assert method.exploration == {"flat": 12, "near": 19, "away": 15}
    assert (len(output["success"]), int(output["success"].sum())) == (408, 83)
    assert {name: len(grid) for name, grid in method.archive.grids.items()} == {
        "start.place": 179,
        "start.flag": 169,
        "end.place": 157,
        "rare.place": 73,
    }
    assert fingerprint(method) == "7a388da6a34b7098"


@pytest.mark.parametrize(
    ("coin", "digest"), [(False, "ba3d7d9454c9110a"), (True, "28cdb6c67d2b07c1")]
)
def test_a_small_run_asks_for_the_same_solutions_as_ever(toy, coin, digest):
    options = {"competition": compete_by_coin(np.random.default_rng(3)), "cells": 9} if coin else {}
    method = new_method(toy, evaluations=1289, seed=7, **options)
    # Rounded, so that they are the same everywhere.
    asked = np.concatenate([solutions for _, solutions in finish(method, toy)])
    rounded = np.round(asked * 1e6).astype("<i8")
    assert hashlib.sha256(rounded.tobytes()).hexdigest()[:16] == digest


def test_the_default_emitter_is_that_of_the_paper(toy):
    one, two = new_method(toy), new_method(toy, emitter=MESEmitter(toy))
    assert [s.tobytes() for _, s in finish(one, toy)] == [s.tobytes() for _, s in finish(two, toy)]


def test_each_short_run_has_an_emitter_of_its_own(toy):
    def second_run(*, first_finds):
        emitter = MESEmitter(toy, shares=CreditedShares(), screen=NeighbourScreen(candidates=2))
        method = new_method(toy, evaluations=960, names=("flat", "near"), emitter=emitter)
        asked = []
        for _ in range(5):
            exploring_flat = "flat" in method.stage
            asked.append(method.ask())
            values = toy.evaluate(asked[-1])
            success = values.success & (first_finds or not exploring_flat)
            method.tell(dataclasses.replace(values, success=success))
        assert not emitter._screen.ready
        return np.stack(asked[3:])

    assert np.array_equal(second_run(first_finds=True), second_run(first_finds=False))


def test_what_an_emitter_failed_on_is_not_told_again(toy, failing_emitter, check_told_once):
    method = new_method(toy, emitter=failing_emitter)
    step(method, toy)
    check_told_once(method, toy.evaluate(method.ask()), state=state)
