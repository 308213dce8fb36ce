import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from ribs.emitters import (
    EvolutionStrategyEmitter,
    GaussianEmitter,
    GeneticAlgorithmEmitter,
    IsoLineEmitter,
)
from ribs.schedulers import Scheduler

from lqd_search import ArchiveError, GridSpec, MultiBDArchive, ValuesError, compete_by_coin

NAN = np.nan
UNIT = (0.0, 1.0)
# Two descriptors: a has one measure and ten cells, b has two and four cells.
GRID_A = GridSpec(dims=(10,), ranges=(UNIT,))
GRID_B = GridSpec(dims=(2, 2), ranges=(UNIT, UNIT))


def new_archive(*, grids=("a", "b"), extra_fields=None, **options):
    archive = MultiBDArchive(
        descriptors={"a": 1, "b": 2},
        solution_dim=2,
        extra_fields={"evaluation": ((), np.int64)} if extra_fields is None else extra_fields,
        **options,
    )
    for name in grids:
        archive.set_grid(name, {"a": GRID_A, "b": GRID_B}[name])
    return archive


def batch(*rows, first=0):
    """Rows of (objective, success, a, (b, b)); row i has the solution (i, i), counted on."""
    ids = np.arange(first, first + len(rows))
    return {
        "solution": np.stack([ids, ids], axis=1).astype(float),
        "objective": np.array([row[0] for row in rows], float),
        "measures": np.array([[row[2], *row[3]] for row in rows], float).reshape(-1, 3),
        "success": np.array([row[1] for row in rows], bool),
        "evaluation": ids,
    }


def holders(archive, name):
    """Which evaluation holds which cell of a grid."""
    elites = archive.grid_elites(name)
    return dict(zip(elites["index"].tolist(), elites["evaluation"].tolist(), strict=True))


def state(archive):
    """Everything that can be read of an archive."""
    grids = {name: archive.grid_elites(name) for name in archive.grids}
    return {
        "specs": dict(archive.specs),
        "clipped": dict(archive.clipped),
        "elites": {
            name: {field: column.tolist() for field, column in elites.items()}
            for name, elites in grids.items()
        },
    }


def test_every_solution_is_offered_to_every_grid_where_it_is_defined():
    archive = new_archive()
    info = archive.add(
        **batch(
            (1.0, False, 0.05, (0.1, 0.1)),
            (2.0, False, 0.95, (NAN, NAN)),
            (3.0, False, NAN, (0.9, 0.9)),
            (4.0, False, NAN, (NAN, NAN)),
        )
    )
    assert holders(archive, "a") == {0: 0, 9: 1}
    assert holders(archive, "b") == {0: 0, 3: 2}
    assert info["status"].tolist() == [2, 2, 2, 0]
    assert info["value"].tolist() == [1.0, 2.0, 3.0, -np.inf]


def test_success_comes_first_in_every_cell():
    archive = new_archive()
    archive.add(**batch((1.0, True, 0.05, (0.1, 0.1)), (9.0, False, 0.95, (0.9, 0.9))))
    info = archive.add(
        **batch(
            (5.0, False, 0.05, (0.1, 0.1)),  # a failure never evicts a success
            (0.0, True, 0.95, (0.9, 0.9)),  # a success evicts any failure
            (1.0, True, 0.05, (0.1, 0.1)),  # a tie keeps the elite
            (-3.0, False, 0.55, (0.1, 0.1)),  # an empty cell takes anything
            first=10,
        )
    )
    assert holders(archive, "a") == {0: 0, 5: 13, 9: 11}
    assert holders(archive, "b") == {0: 0, 3: 11}
    assert info["status"].tolist() == [0, 1, 0, 2]
    assert info["value"].tolist() == [4.0, -9.0, 0.0, -3.0]


def test_the_grids_differ_in_who_wins():
    archive = new_archive()
    archive.add(**batch((1.0, False, 0.05, (0.1, 0.1)), (2.0, False, 0.95, (0.1, 0.1))))
    assert holders(archive, "a") == {0: 0, 9: 1}
    assert holders(archive, "b") == {0: 1}
    assert len(archive) == 2
    assert archive.grids["a"].cells == 10


def test_the_competition_can_be_another():
    archive = new_archive(competition=compete_by_coin(np.random.default_rng(0)))
    archive.add(**batch((9.0, False, 0.05, (NAN, NAN))))
    for i in range(1, 30):
        archive.add(**batch((0.0, False, 0.05, (NAN, NAN)), first=i))
    assert holders(archive, "a")[0] > 0


def test_far_outliers_go_to_the_right_edge_and_are_counted():
    archive = new_archive()
    archive.add(
        **batch(
            (0.0, False, 1e30, (0.1, 0.1)),
            (0.0, False, -1e308, (0.1, 1.2)),
            (0.0, False, 1.0, (NAN, NAN)),
            (1.0, False, 1.7, (NAN, NAN)),
        )
    )
    assert holders(archive, "a") == {0: 1, 9: 3}
    assert holders(archive, "b") == {0: 0, 1: 1}
    assert dict(archive.clipped) == {"a": 3, "b": 1}
    assert archive.grid_elites("a")["measures"][1].tolist() == [1.7]


@pytest.mark.parametrize("solution", [1.0, np.float64(2.0), None])
def test_a_single_value_is_no_batch(solution):
    with pytest.raises(ArchiveError, match="Expected a column of solutions, but got the single"):
        new_archive().add(**{**batch((0.0, False, 0.1, (0.1, 0.1))), "solution": solution})


@pytest.mark.parametrize("copied", [lambda a: a, lambda a: pickle.loads(pickle.dumps(a))])
def test_measures_far_out_of_range_are_stored_as_they_are(copied):
    archive = new_archive()
    archive.add(**batch((0.0, False, 1e30, (0.1, -1e308)), (0.0, False, -5e4, (0.9, 0.1))))

    archive = copied(archive)

    for elites in (archive.grid_elites("a"), archive.grids["a"].data()):
        assert sorted(elites["measures"].ravel().tolist()) == [-5e4, 1e30]
    assert archive.grid_elites("b")["measures"].tolist() == [[0.1, -1e308], [0.9, 0.1]]
    assert holders(archive, "a") == {0: 1, 9: 0}
    assert archive.grids["a"].index_of([[1e30], [-5e4]]).tolist() == [9, 0]


def test_huge_objectives_are_no_trouble():
    archive = new_archive()
    archive.add(**batch((1e308, False, 0.05, (NAN, NAN)), (-1e308, True, 0.05, (NAN, NAN))))
    archive.add(
        **batch((1.5e308, True, 0.05, (NAN, NAN)), (1e308, True, 0.95, (NAN, NAN)), first=2)
    )
    archive.add(**batch((1.6e308, True, 0.55, (NAN, NAN)), first=4))
    assert holders(archive, "a") == {0: 2, 5: 4, 9: 3}


def test_a_descriptor_without_grid_waits():
    archive = new_archive(grids=("b",))
    archive.add(**batch((1.0, False, 0.05, (0.1, 0.1))))
    assert list(archive.grids) == ["b"]
    archive.set_grid("a", GRID_A)
    assert list(archive.grids) == ["a", "b"]
    assert archive.grids["a"].empty
    with pytest.raises(ArchiveError, match="'a' has no grid yet; those with one: b"):
        new_archive(grids=("b",)).grid_elites("a")


def test_without_any_grid_nothing_gets_in():
    archive = new_archive(grids=())
    info = archive.add(**batch((1.0, True, 0.05, (0.1, 0.1))))
    assert archive.empty
    assert len(archive) == 0
    assert info["status"].tolist() == [0]
    assert archive.elites().fields["solution"].shape == (0, 2)
    assert archive.elites().fields["success"].dtype == bool


def test_grids_can_be_replaced_dropped_and_cleared():
    archive = new_archive()
    archive.add(**batch((1.0, False, 2.0, (0.1, 0.1))))
    archive.set_grid("a", GridSpec(dims=(4,), ranges=((0.0, 4.0),)))
    assert archive.grids["a"].empty
    assert archive.clipped["a"] == 0
    assert holders(archive, "b") == {0: 0}
    archive.drop_grid("a")
    archive.drop_grid("a")
    assert list(archive.grids) == ["b"]
    archive.clear()
    assert archive.empty
    assert dict(archive.specs) == {"b": GRID_B}


@pytest.mark.parametrize("call", ["drop_grid", "grid_elites"])
def test_an_unknown_descriptor_is_named(call):
    with pytest.raises(ArchiveError, match="Unknown descriptor 'c'; the archive has a, b"):
        getattr(new_archive(), call)("c")


def test_a_grid_must_have_the_descriptors_dimensions():
    with pytest.raises(ArchiveError, match=r"grid of 1 dimensions for descriptor 'a'.* one of 2"):
        new_archive().set_grid("a", GRID_B)
    with pytest.raises(ArchiveError, match="Unknown descriptor 'c'"):
        new_archive().set_grid("c", GRID_B)


ROW = (1.0, True, 0.5, (0.5, 0.5))


@pytest.mark.parametrize(
    ("changes", "error", "message"),
    [
        ({"solution": np.zeros((2, 3))}, ArchiveError, r"solution to have shape \(2, 2\)"),
        ({"solution": np.array([[0, NAN], [0, 0]])}, ArchiveError, "Expected finite solutions"),
        ({"objective": np.zeros(3)}, ArchiveError, r"objective to have shape \(2,\)"),
        ({"objective": np.array([0, NAN])}, ArchiveError, "Expected finite objectives"),
        ({"objective": np.array([0, np.inf])}, ArchiveError, "Expected finite objectives"),
        ({"objective": np.array([0, -1.7976931348623157e308])}, ArchiveError, "finite objectives"),
        ({"objective": np.array([1j, 0])}, ArchiveError, "objective to have dtype float64"),
        ({"measures": np.zeros((2, 2))}, ArchiveError, r"measures to have shape \(2, 3\)"),
        ({"measures": np.array([[0, 0, 0], [0, 0, NAN]])}, ValuesError, "measures 'b'.* row 1"),
        ({"measures": np.array([[np.inf, 0, 0]] * 2)}, ValuesError, "measures 'a'.* row 0"),
        ({"success": np.zeros(2)}, ArchiveError, "success to have dtype bool, but it has float64"),
        ({"success": np.zeros(1, bool)}, ArchiveError, r"success to have shape \(2,\)"),
        ({"evaluation": np.zeros(2)}, ArchiveError, "evaluation to have dtype int64"),
        ({"evaluation": np.zeros((2, 1), int)}, ArchiveError, r"evaluation to have shape \(2,\)"),
        ({"colour": np.zeros(2)}, ArchiveError, "evaluation, but got .*, colour"),
    ],
)
def test_a_batch_is_checked_before_any_grid_is_touched(changes, error, message):
    archive = new_archive()
    archive.add(**batch((1.0, True, 0.2, (0.2, 0.2)), (0.0, False, 2.0, (NAN, NAN))))
    before = state(archive)
    with pytest.raises(error, match=message):
        archive.add(**batch(ROW, ROW, first=5) | changes)
    assert state(archive) == before


def test_a_missing_field_is_named():
    rows = batch(ROW)
    del rows["success"]
    with pytest.raises(ArchiveError, match="solution, objective, measures, success, evaluation"):
        new_archive().add(**rows)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"descriptors": {}}, r"at least one descriptor.*\{\}"),
        ({"descriptors": {"a": 0}}, r"at least one measure.*\{'a': 0\}"),
        ({"descriptors": {"a": 1}, "extra_fields": {"index": ((), int)}}, "but got 'index'"),
        ({"descriptors": {"a": 1}, "extra_fields": {"my field": ((), int)}}, "but got 'my field'"),
    ],
)
def test_an_archive_without_sense_is_refused(options, message):
    with pytest.raises(ArchiveError, match=message):
        MultiBDArchive(solution_dim=2, **options)


@pytest.mark.parametrize("halfway", [False, True])
def test_a_grid_that_fails_leaves_all_as_it_was(monkeypatch, halfway):
    archive, untouched = new_archive(), new_archive()
    rng = np.random.default_rng(1)
    for twin in (archive, untouched):
        twin.add(**random_batch(np.random.default_rng(0), 40))
    before = state(archive)
    grid = archive.grids["b"]
    add = grid.add

    def fail(**fields):
        if halfway:
            add(**fields)
        raise OSError("the disk of this grid is full")

    monkeypatch.setattr(grid, "add", fail)
    rows = random_batch(rng, 40, first=40)
    with pytest.raises(OSError, match="full"):
        archive.add(**rows)
    assert state(archive) == before
    archive.add(**rows)
    untouched.add(**rows)
    assert state(archive) == state(untouched)
    assert state(archive) != before


def random_batch(rng, n, *, first=0):
    defined = rng.random((n, 2)) < 0.8
    rows = zip(
        rng.integers(-3, 3, n),
        rng.random(n) < 0.4,
        np.where(defined[:, 0], rng.uniform(-0.1, 1.1, n), NAN),
        np.where(defined[:, 1:], rng.uniform(-0.1, 1.1, (n, 2)), NAN),
        strict=True,
    )
    return batch(*rows, first=first)


@given(st.integers(0, 2**32), st.lists(st.integers(0, 25), min_size=1, max_size=4))
@settings(max_examples=40, deadline=None)
def test_batches_come_out_as_one_by_one(seed, sizes):
    together, single = new_archive(), new_archive()
    rng = np.random.default_rng(seed)
    first = 0
    for n in sizes:
        rows = random_batch(rng, n, first=first)
        together.add(**rows)
        for i in range(n):
            single.add_single(**{name: column[i] for name, column in rows.items()})
        first += n
    assert state(together) == state(single)


def test_equal_solutions_are_one_elite_with_its_first_evaluation():
    archive = new_archive()
    rows = batch(
        (1.0, True, 0.05, (NAN, NAN)),
        (1.0, False, 0.15, (0.1, 0.1)),
        (2.0, True, NAN, (0.9, 0.9)),
        (2.0, True, 0.95, (NAN, NAN)),
    )
    rows["solution"] = np.array([[7.0, 0.0], [3.0, 3.0], [5.0, 5.0], [7.0, -0.0]])
    rows["evaluation"] = np.array([3, 2, 1, 0])
    archive.add(**rows)
    elites = archive.elites()
    assert elites.fields["solution"].tolist() == [[7.0, 0.0], [5.0, 5.0], [3.0, 3.0]]
    assert elites.fields["evaluation"].tolist() == [0, 1, 2]
    assert elites.cells["a"].tolist() == [0, 1, 9]
    assert elites.rows["a"].tolist() == [0, 2, 0]
    assert elites.cells["b"].tolist() == [0, 3]
    assert elites.rows["b"].tolist() == [2, 1]
    assert len(elites) == len(archive) == 3
    assert elites.successes == 2


def test_without_evaluations_the_union_is_in_order_of_appearance():
    archive = new_archive(extra_fields={})
    rows = batch(
        (1.0, True, 0.95, (0.1, 0.1)), (1.0, True, 0.05, (NAN, NAN)), (2.0, True, NAN, (0.9, 0.9))
    )
    del rows["evaluation"]
    archive.add(**rows)
    assert archive.elites().fields["solution"][:, 0].tolist() == [1.0, 0.0, 2.0]
    assert archive.elites().rows["b"].tolist() == [1, 2]


def test_statistics_are_over_distinct_elites_and_all_cells():
    archive = new_archive()
    assert archive.stats.num_elites == 0
    assert archive.stats.obj_max is None
    archive.add(**batch((1.0, True, 0.05, (0.1, 0.1)), (4.0, False, 0.95, (NAN, NAN))))
    stats = archive.stats
    assert stats.num_elites == 2
    assert stats.coverage == 3 / 14
    assert (stats.qd_score, stats.obj_max, stats.obj_mean) == (5.0, 4.0, 2.5)
    assert stats.norm_qd_score == 5.0 / 14


def test_elites_are_sampled_from_the_union():
    archive = new_archive(seed=0)
    archive.add(**batch((1.0, True, 0.05, (0.1, 0.1)), (4.0, False, 0.95, (NAN, NAN))))
    assert np.bincount(archive.sample_elites(2000)["evaluation"]).tolist() == pytest.approx(
        [1000, 1000], rel=0.1
    )
    assert sorted(archive.sample_elites(2, replace=False)["evaluation"]) == [0, 1]
    with pytest.raises(ArchiveError, match=r"draw 3 elites without replacement.* has 2"):
        archive.sample_elites(3, replace=False)
    with pytest.raises(ArchiveError, match=r"draw 3 elites with replacement.* has 0"):
        new_archive().sample_elites(3)


def test_it_can_be_pickled_and_goes_on_the_same():
    archive = new_archive(seed=0, competition=compete_by_coin(np.random.default_rng(5)))
    archive.add(**random_batch(np.random.default_rng(0), 40))
    twin = pickle.loads(pickle.dumps(archive))
    rows = random_batch(np.random.default_rng(1), 40, first=40)
    archive.add(**rows)
    twin.add(**rows)
    assert state(archive) == state(twin)
    sampled = archive.sample_elites(9)["evaluation"].tolist()
    assert sampled == twin.sample_elites(9)["evaluation"].tolist()


STOCK = {"x0": [0.5, 0.5], "batch_size": 20, "seed": 2}
LINES = {"iso_sigma": 0.1, "line_sigma": 0.2}
STOCK_EMITTERS = {
    "Gaussian": lambda archive: GaussianEmitter(archive, sigma=0.2, **STOCK),
    "iso+line": lambda archive: IsoLineEmitter(archive, **LINES, **STOCK),
    "genetic": lambda archive: GeneticAlgorithmEmitter(
        archive, operator="isoline", operator_kwargs=LINES, **STOCK
    ),
    **{
        f"CMA-ME, {ranker}": lambda archive, ranker=ranker: EvolutionStrategyEmitter(
            archive, sigma0=0.2, ranker=ranker, **STOCK
        )
        for ranker in ("imp", "2imp", "obj", "2obj")
    },
}


@pytest.mark.parametrize("add_mode", ["batch", "single"])
@pytest.mark.parametrize("make_emitter", STOCK_EMITTERS.values(), ids=STOCK_EMITTERS)
def test_stock_schedulers_and_emitters_of_pyribs_run_on_it(make_emitter, add_mode):
    archive = new_archive(seed=1)
    emitter = make_emitter(archive)
    scheduler = Scheduler(archive, [emitter], add_mode=add_mode)
    for generation in range(5):
        solutions = scheduler.ask()
        scheduler.tell(
            -np.abs(solutions).sum(axis=1),
            np.concatenate([solutions[:, :1], solutions], axis=1),
            success=solutions[:, 0] > 0.5,
            evaluation=np.arange(20) + 20 * generation,
        )
    assert len(archive.grids["b"]) in (2, 3, 4)
    assert len(archive.grids["a"]) > 5
    right = archive.grid_elites("b")
    assert right["success"].tolist() == (right["solution"][:, 0] > 0.5).tolist()
    assert right["success"].any()
