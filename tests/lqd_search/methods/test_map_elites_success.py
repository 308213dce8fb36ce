import dataclasses
import hashlib
import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lqd_search import (
    ArchiveError,
    GridSpec,
    MESEmitter,
    MethodError,
    MultiBDArchive,
    SchedulerError,
    compete_by_coin,
)
from lqd_search.emitters.mixed_emitter import MixedEmitter, Part
from lqd_search.emitters.screen import NeighbourScreen
from lqd_search.emitters.shares import CreditedShares
from lqd_search.methods.map_elites_success import MapElitesSuccess

PASSIVE = {"expert": ((), np.bool_)}
GIVEN = {"start.place": GridSpec(dims=(10, 10), ranges=((0.0, 1.0), (0.0, 1.0)))}


def new_method(toy, *, evaluations=320, batch_size=32, seed=0, descriptors=None, **options):
    options = {"passive_fields": PASSIVE, "minimum": 16, "cells": 400} | options
    return MapElitesSuccess(
        toy,
        descriptors=descriptors or toy.descriptors,
        fitness="near",
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
    """Go on until all is done, and return the generations."""
    generations = []
    while not method.done:
        generations.append(step(method, toy))
    return generations


def state(method):
    archive = method.archive
    return {
        "specs": dict(archive.specs),
        "clipped": dict(archive.clipped),
        "evaluations": method.evaluations,
        "stage": method.stage,
        "elites": {
            name: {field: c.tolist() for field, c in archive.grid_elites(name).items()}
            for name in archive.grids
        },
    }


@given(evaluations=st.integers(1, 150), batch_size=st.integers(1, 40))
@settings(max_examples=25, deadline=None)
def test_exactly_the_budget_is_spent(toy, evaluations, batch_size):
    method = new_method(toy, evaluations=evaluations, batch_size=batch_size)
    assert method.stage == "first batch"
    sizes = [len(solutions) for solutions in finish(method, toy)]
    full, rest = divmod(evaluations, batch_size)
    assert sizes == [batch_size] * full + [rest] * (rest > 0)
    assert method.evaluations == evaluations
    assert method.stage == "searching with near"
    assert (method.exploration, method.chosen) == ({}, None)
    with pytest.raises(MethodError, match="since all evaluations are spent"):
        method.ask()


def test_the_first_batch_is_random(toy):
    first = new_method(toy).ask()
    assert np.array_equal(first, toy.sample(32, rng=np.random.default_rng(0)))


def test_the_output_is_the_union_of_the_elites(toy):
    method = new_method(toy)
    assert len(method.output()["solution"]) == 0
    asked = np.concatenate(finish(method, toy))
    output = method.output()
    values = toy.evaluate(output["solution"])
    assert list(output) == ["solution", "objective", "success", "evaluation", "expert"]
    assert values.valid.all()
    assert output["success"].tolist() == values.success.tolist()
    assert output["objective"].tolist() == values.fitness["near"].tolist()
    assert output["expert"].tolist() == values.passive["expert"].tolist()
    assert asked[output["evaluation"]].tolist() == output["solution"].tolist()
    assert (np.diff(output["evaluation"]) > 0).all()


@given(seed=st.integers(0, 50), coin=st.booleans(), relearn_at=st.none() | st.integers(1, 150))
@settings(max_examples=20, deadline=None)
def test_every_elite_is_in_its_cell_and_no_success_was_lost(toy, seed, coin, relearn_at):
    options = {"competition": compete_by_coin(np.random.default_rng(seed))} if coin else {}
    method = new_method(
        toy, evaluations=150, batch_size=25, seed=seed, cells=9, relearn_at=relearn_at, **options
    )
    asked = np.concatenate(finish(method, toy))
    values = toy.evaluate(asked)
    for name, grid in method.archive.grids.items():
        elites = method.archive.grid_elites(name)
        evaluation = elites["evaluation"]
        assert elites["solution"].tolist() == asked[evaluation].tolist()
        assert elites["measures"].tolist() == values.measures[name][evaluation].tolist()
        offered = np.flatnonzero(values.valid & ~np.isnan(values.measures[name][:, 0]))
        cells = grid.index_of(values.measures[name][offered])
        assert grid.index_of(elites["measures"]).tolist() == elites["index"].tolist()
        # Learning the ranges again offers the elites alone, and may leave a cell empty.
        assert relearn_at is not None or set(cells) == set(elites["index"])
        for cell, i, success in zip(elites["index"], evaluation, elites["success"], strict=True):
            rivals = offered[cells == cell]
            if relearn_at is None:
                assert success == values.success[rivals].any()
            if relearn_at is None and (success or not coin):
                peers = rivals[values.success[rivals] == success]
                assert i == peers[np.argmax(values.fitness["near"][peers])]


def test_the_same_seed_gives_the_same_run_and_another_one_another(toy):
    one, two, other = (
        np.concatenate(finish(new_method(toy, seed=seed), toy)) for seed in (1, 1, 2)
    )
    assert one.tobytes() == two.tobytes()
    assert one.tobytes() != other.tobytes()


def learning_emitter(toy):
    inner = MESEmitter(toy, shares=CreditedShares(), screen=NeighbourScreen())
    return MixedEmitter(inner, [Part(MESEmitter(toy), 0.3)])


@pytest.mark.parametrize("coin", [False, True])
@pytest.mark.parametrize("generations", [0, 1, 3, 4, 7])
def test_pickled_in_the_middle_it_goes_on_bit_for_bit(toy, generations, coin):
    options = {"competition": compete_by_coin(np.random.default_rng(3))} if coin else {}
    method = new_method(toy, relearn_at=100, emitter=learning_emitter(toy), **options)
    for _ in range(generations):
        step(method, toy)
    twin = pickle.loads(pickle.dumps(method))
    assert [s.tobytes() for s in finish(method, toy)] == [s.tobytes() for s in finish(twin, toy)]
    assert state(method) == state(twin)


def test_two_methods_do_not_share_an_emitter(toy):
    emitter = learning_emitter(toy)
    alone = np.concatenate(finish(new_method(toy, emitter=emitter), toy))
    one, two = (new_method(toy, emitter=emitter) for _ in range(2))
    history = []
    while not one.done:
        history.append(step(one, toy))
        step(two, toy)
    assert np.concatenate(history).tobytes() == alone.tobytes()


@pytest.mark.parametrize("generations", [0, 2, 3, 5])
def test_after_an_error_in_tell_it_can_be_told_again(toy, generations):
    method, twin = (new_method(toy, relearn_at=128) for _ in range(2))
    for _ in range(generations):
        step(method, toy)
        step(twin, toy)
    values = toy.evaluate(method.ask())
    before = state(method)
    with pytest.raises(SchedulerError, match="but got 31"):
        method.tell(toy.evaluate(np.zeros((31, 3))))
    with pytest.raises(SchedulerError, match="Expected the fitness 'near'"):
        method.tell(dataclasses.replace(values, fitness={}))
    with pytest.raises(SchedulerError, match="Expected the measures 'start"):
        method.tell(dataclasses.replace(values, measures={}))
    with pytest.raises(ArchiveError, match="expert to have dtype bool"):
        method.tell(dataclasses.replace(values, passive={"expert": np.zeros(32)}))
    assert state(method) == before
    method.tell(values)
    finish(method, toy)
    finish(twin, toy)
    assert state(method) == state(twin)


@pytest.mark.parametrize("coin", [False, True])
def test_an_error_while_ranges_are_learned_again_leaves_nothing_half_told(toy, monkeypatch, coin):
    def new():
        options = {"competition": compete_by_coin(np.random.default_rng(3))} if coin else {}
        method = new_method(toy, relearn_at=100, cells=16, emitter=learning_emitter(toy), **options)
        for _ in range(3):
            step(method, toy)
        return method

    method, twin = new(), new()
    values = toy.evaluate(method.ask())
    before = state(method)

    def fail(*_):
        raise MemoryError("while the grids were rebuilt")

    with monkeypatch.context() as patch:
        patch.setattr(MultiBDArchive, "emptied", fail)
        with pytest.raises(MemoryError, match="rebuilt"):
            method.tell(values)
    assert state(method) == before
    method.tell(values)
    step(twin, toy)
    assert state(method) == state(twin)
    assert state(method)["specs"] != before["specs"]
    assert [s.tobytes() for s in finish(method, toy)] == [s.tobytes() for s in finish(twin, toy)]


def test_ranges_are_learned_again_once_from_everything(toy):
    method = new_method(toy, relearn_at=100)
    seen, specs = [], []
    while not method.done:
        values = toy.evaluate(step(method, toy))
        seen.append(values.measures["start.place"][values.valid])
        specs.append(method.archive.specs["start.place"])
    # The fourth generation is that in which 100 evaluations are reached.
    assert len(set(specs[:3])) == len(set(specs[3:])) == 1
    assert specs[2] != specs[3]
    values = np.concatenate(seen[:4])
    lower, upper = values.min(axis=0), values.max(axis=0)
    padding = 0.05 * (upper - lower)
    assert np.array(specs[3].ranges) == pytest.approx(
        np.stack([lower - padding, upper + padding], axis=1)
    )


def test_ranges_are_never_learned_again_unless_it_is_wanted(toy):
    for relearn_at in (None, 321):
        method = new_method(toy, relearn_at=relearn_at)
        step(method, toy)
        first = method.archive.specs["start.place"]
        finish(method, toy)
        assert method.archive.specs["start.place"] == first


def test_a_given_grid_is_never_learned(toy):
    method = new_method(toy, descriptors={"start.place": 2}, grids=GIVEN)
    assert method.archive.specs == GIVEN
    finish(method, toy)
    assert method.archive.specs == GIVEN
    assert len(method.output()["solution"]) > 0


def test_given_grids_stand_beside_learned_ones_in_the_descriptors_order(toy):
    grids = {"end.place": GridSpec(dims=(3, 3, 3), ranges=((0.0, 1.0),) * 3)}
    method = new_method(toy, grids=grids)
    assert dict(method.archive.specs) == grids
    finish(method, toy)
    # The rare one may still wait for its values.
    known = [name for name in toy.descriptors if name in method.archive.specs]
    assert list(method.archive.specs) == known
    assert known[:3] == ["start.place", "start.flag", "end.place"]
    assert method.archive.specs["end.place"] == grids["end.place"]
    assert len(method.archive.grid_elites("end.place")["index"]) > 1


def test_what_was_handed_out_can_be_changed_without_harm(toy):
    method, twin = new_method(toy), new_method(toy)
    while not method.done:
        solutions = method.ask()
        values = toy.evaluate(solutions)
        solutions[:] = 0.0
        method.tell(values)
        for column in (values.fitness["near"], values.valid, values.passive["expert"]):
            column[:] = 0
    finish(twin, toy)
    assert state(method) == state(twin)


def test_what_is_passive_does_not_steer(toy):
    def run(expert):
        method = new_method(toy)
        asked = []
        while not method.done:
            asked.append(method.ask())
            passive = {"expert": expert(len(asked[-1]))}
            method.tell(dataclasses.replace(toy.evaluate(asked[-1]), passive=passive))
        return np.concatenate(asked).tobytes()

    assert run(lambda n: np.zeros(n, bool)) == run(lambda n: np.arange(n) % 2 == 0)


def test_ask_and_tell_take_turns(toy):
    method = new_method(toy)
    with pytest.raises(MethodError, match="Expected a call of ask before tell"):
        method.tell(toy.evaluate(np.zeros((32, 3))))
    method.ask()
    with pytest.raises(MethodError, match="since the last ones were not told yet"):
        method.ask()


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"evaluations": 0}, MethodError, "at least 1 evaluation.* but got 0, 32 and None"),
        ({"batch_size": 0}, MethodError, "but got 320, 0 and None"),
        ({"relearn_at": 0}, MethodError, "but got 320, 32 and 0"),
        (
            {"grids": GIVEN, "relearn_at": 9},
            MethodError,
            "grids of start.place and relearn_at=9; leave one out",
        ),
        ({"grids": {"x": GIVEN["start.place"]}}, MethodError, "descriptors start.place.* of x and"),
        ({"grids": {"end.place": GIVEN["start.place"]}}, ArchiveError, "a grid of 3 dimensions"),
        ({"descriptors": {"a": 0}}, ArchiveError, "each with at least one measure"),
        ({"passive_fields": {"index": ((), np.int64)}}, ArchiveError, "but got 'index'; rename"),
    ],
)
def test_what_makes_no_sense_is_refused(toy, options, error, message):
    with pytest.raises(error, match=message):
        new_method(toy, **options)


def test_more_successes_than_at_random(toy):
    method = new_method(toy, evaluations=1280, cells=10_000)
    finish(method, toy)
    random = toy.evaluate(toy.sample(1280, rng=np.random.default_rng(0)))
    assert method.output()["success"].sum() > 2 * random.success.sum() > 0


def test_a_small_run_comes_out_as_ever(toy):
    method = new_method(toy, evaluations=489, seed=7, relearn_at=100)
    # Rounded, so that it is the same everywhere.
    asked = np.round(np.concatenate(finish(method, toy)) * 1e6).astype("<i8")
    assert hashlib.sha256(asked.tobytes()).hexdigest()[:16] == "298321daf5a29f8e"


def test_what_an_emitter_failed_on_is_not_told_again(toy, failing_emitter, check_told_once):
    method = new_method(toy, emitter=failing_emitter)
    step(method, toy)
    check_told_once(method, toy.evaluate(method.ask()), state=state)


def test_where_ranges_are_learned_again_even_an_emitter_s_error_changes_nothing(
    toy, failing_emitter
):
    method = new_method(toy, emitter=failing_emitter, relearn_at=64)
    step(method, toy)
    values = toy.evaluate(method.ask())
    before = state(method)
    for _ in range(2):
        with pytest.raises(OSError, match="out of ideas"):
            method.tell(values)
        assert state(method) == before
