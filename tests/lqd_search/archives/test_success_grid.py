import copy
import pickle

import numpy as np
import pytest
from ribs.archives import GridArchive

from lqd_search import GridSpec, MultiBDArchive, compete_by_coin, compete_by_fitness
from lqd_search.archives.cell_rows import CellRows

LENGTHS = {"a": 1, "b": 2, "c": 3}
SPECS = {
    "a": GridSpec(dims=(30,), ranges=((0.0, 1.0),)),
    "b": GridSpec(dims=(6, 5), ranges=((0.0, 1.0), (0.0, 1.0))),
    "c": GridSpec(dims=(3, 1, 4), ranges=((0.0, 1.0), (-9.0, 9.0), (0.2, 0.8))),
}
EXTRA = {
    "evaluation": ((), np.int64),
    "place": ((3,), np.float64),
    "label": ((), object),
    "digest": (2, np.uint64),
}
COMPETITIONS = {
    "fitness": lambda: compete_by_fitness,
    "coin": lambda: compete_by_coin(np.random.default_rng(7)),
}


def new_archive(competition="fitness"):
    archive = MultiBDArchive(
        descriptors=LENGTHS,
        solution_dim=2,
        extra_fields=EXTRA,
        competition=COMPETITIONS[competition](),
        seed=3,
    )
    for name, spec in SPECS.items():
        archive.set_grid(name, spec)
    return archive


def batch(seed, n=40):
    rng = np.random.default_rng(seed)
    blocks = [
        np.where(rng.random((n, 1)) < 0.6, rng.uniform(-0.1, 1.1, (n, d)), np.nan)
        for d in LENGTHS.values()
    ]
    return {
        "solution": rng.normal(size=(n, 2)),
        "objective": rng.integers(-3, 4, n) + 0.0,
        "measures": np.concatenate(blocks, axis=1),
        "success": rng.random(n) < 0.3,
        "evaluation": n * seed + np.arange(n),
        "place": rng.normal(size=(n, 3)),
        "label": np.array([f"{seed}/{i}" for i in range(n)], object),
        "digest": rng.integers(2**64, size=(n, 2), dtype=np.uint64),
    }


def listed(columns):
    return {name: (str(c.dtype), c.tolist()) for name, c in columns.items()}


def state(archive):
    """Everything that can be read of an archive, from its caches, its rows and from pyribs."""
    union = archive.elites()
    grids = {}
    for name, grid in archive.grids.items():
        data = grid.data()
        del data["threshold"]
        order = np.argsort(data["index"])
        grids[name] = listed({field: column[order] for field, column in data.items()})
        assert listed(archive.grid_elites(name)) == grids[name]
        assert len(grid) == archive.filled[name]
        assert grid.data("success").sum() == archive.successes[name]
    parts = [listed(part) for part in (union.fields, union.rows, union.cells)]
    return (parts, grids, dict(archive.specs), dict(archive.clipped), archive.empty)


@pytest.mark.parametrize("copied", [lambda a: pickle.loads(pickle.dumps(a)), copy.deepcopy])
@pytest.mark.parametrize("competition", COMPETITIONS)
def test_a_copy_goes_on_bit_for_bit(copied, competition):
    archive = new_archive(competition)
    for seed in range(3):
        archive.add(**batch(seed))
    twin = copied(archive)
    assert state(twin) == state(archive)
    for seed in range(3, 8):
        ours, theirs = archive.add(**batch(seed)), twin.add(**batch(seed))
        assert listed(ours) == listed(theirs)
        assert state(twin) == state(archive)
        assert listed(archive.sample_elites(5)) == listed(twin.sample_elites(5))
        twin = copied(twin)


def test_a_copy_of_an_empty_archive_is_empty():
    twin = pickle.loads(pickle.dumps(new_archive()))
    assert twin.empty
    twin.add(**batch(0))
    archive = new_archive()
    archive.add(**batch(0))
    assert state(twin) == state(archive)


def test_empty_cells_and_caches_are_not_pickled():
    few, many = new_archive(), new_archive()
    many.set_grid("a", GridSpec(dims=(100_000,), ranges=((0.0, 1.0),)))
    for archive in (few, many):
        archive.add(**batch(0))
    size = len(pickle.dumps(many))
    assert size < 2 * len(pickle.dumps(few))
    many.elites()
    assert len(pickle.dumps(many)) == size


CHANGES = {
    "add": lambda archive: archive.add(**batch(1)),
    "set_grid": lambda archive: archive.set_grid("b", SPECS["b"]),
    "drop_grid": lambda archive: archive.drop_grid("b"),
    "clear": lambda archive: archive.clear(),
}


@pytest.mark.parametrize("change", CHANGES)
def test_what_is_cached_is_forgotten_after_every_change(change):
    cached, fresh = new_archive(), new_archive()
    for archive in (cached, fresh):
        archive.add(**batch(0))
    before = state(cached)
    for archive in (cached, fresh):
        CHANGES[change](archive)
    assert state(cached) == state(fresh) != before


def test_elites_are_computed_once_and_cannot_be_spoilt():
    archive = new_archive()
    archive.add(**batch(0))
    before = state(archive)
    assert archive.elites().fields["solution"] is archive.elites().fields["solution"]
    assert archive.grid_elites("a")["solution"] is archive.grid_elites("a")["solution"]
    elites = archive.elites()
    for part in (elites.fields, elites.rows, elites.cells, archive.grid_elites("a")):
        for column in part.values():
            with pytest.raises(ValueError, match="read-only"):
                column[0] = column[1]
        part.clear()
    assert state(archive) == before


def test_a_batch_that_changes_nothing_keeps_the_cache():
    archive = new_archive()
    archive.add(**batch(0))
    solution = archive.elites().fields["solution"]
    archive.add(**batch(0))
    assert archive.elites().fields["solution"] is solution


@pytest.mark.parametrize("error", [MemoryError, KeyboardInterrupt])
@pytest.mark.parametrize("step", [GridArchive.add, CellRows.write], ids=["pyribs", "rows"])
@pytest.mark.parametrize("halfway", [False, True])
@pytest.mark.parametrize("nth", [1, 3])
@pytest.mark.parametrize("competition", COMPETITIONS)
def test_an_error_in_any_grid_leaves_all_as_it_was(
    monkeypatch, error, step, halfway, nth, competition
):
    archive, untouched = new_archive(competition), new_archive(competition)
    for twin in (archive, untouched):
        twin.add(**batch(0))
        state(twin)
    calls = []

    def fail(*args, **fields):
        calls.append(args)
        if len(calls) != nth or halfway:
            step(*args, **fields)
        if len(calls) == nth:
            raise error

    with monkeypatch.context() as patch:
        patch.setattr(GridArchive if step is GridArchive.add else CellRows, step.__name__, fail)
        with pytest.raises(error):
            archive.add(**batch(1))
    assert len(calls) >= nth
    assert state(archive) == state(untouched)
    for seed in (1, 2):
        ours, theirs = archive.add(**batch(seed)), untouched.add(**batch(seed))
        assert listed(ours) == listed(theirs)
    assert state(archive) == state(untouched)


def test_a_competition_that_fails_leaves_all_as_it_was():
    contests = []

    def interrupted(candidates, incumbents):
        contests.append(candidates)
        if len(contests) == 5:
            raise KeyboardInterrupt
        return compete_by_fitness(candidates, incumbents)

    archive = MultiBDArchive(
        descriptors=LENGTHS, solution_dim=2, extra_fields=EXTRA, competition=interrupted
    )
    for name, spec in SPECS.items():
        archive.set_grid(name, spec)
    archive.add(**batch(0))
    before = state(archive)
    with pytest.raises(KeyboardInterrupt):
        archive.add(**batch(1))
    assert state(archive) == before
