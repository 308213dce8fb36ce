import numpy as np
import pytest

from lqd_search import ArchiveError, GridSpec, MESEmitter, MultiBDArchive, SelectionError


class Marking:
    """A space whose mutants are their parents, marked by a hundred."""

    dim = 1

    def sample(self, n, *, rng):  # noqa: ARG002 -- the protocol's
        raise AssertionError("nothing was to be sampled")

    def mutate(self, parents, *, rng):  # noqa: ARG002 -- the protocol's
        return parents + 100.0


def archive_with(success):
    archive = MultiBDArchive(descriptors={"a": 1, "b": 1}, solution_dim=1)
    archive.set_grid("a", GridSpec(dims=(10,), ranges=((0.0, 10.0),)))
    n = len(success)
    archive.add(
        solution=np.arange(n, dtype=float)[:, None],
        objective=np.zeros(n),
        measures=np.stack([np.arange(n) + 0.5, np.full(n, np.nan)], axis=1),
        success=np.array(success, bool),
    )
    return archive


def test_it_mutates_successes_first():
    emitter = MESEmitter(archive_with([True, False, True, True]), "a", Marking())
    solutions = emitter.ask(3, rng=np.random.default_rng(0))
    assert sorted(solutions[:, 0]) == [100.0, 102.0, 103.0]
    solutions = emitter.ask(4, rng=np.random.default_rng(0))
    assert sorted(solutions[:, 0]) == [100.0, 101.0, 102.0, 103.0]


def test_what_it_makes_depends_on_the_generator_alone():
    emitter = MESEmitter(archive_with([False] * 6), "a", Marking())
    asked = [emitter.ask(4, rng=np.random.default_rng(5)).tolist() for _ in range(2)]
    assert asked[0] == asked[1]


def test_the_order_in_which_cells_were_filled_does_not_matter():
    archive, reverse = archive_with([True, False, True, True]), archive_with([])
    elites = archive.grid_elites("a")
    for i in reversed(range(4)):
        reverse.add_single(
            elites["solution"][i],
            elites["objective"][i],
            [*elites["measures"][i], np.nan],
            success=elites["success"][i],
        )
    asked = [
        MESEmitter(a, "a", Marking()).ask(6, rng=np.random.default_rng(5)).tolist()
        for a in (archive, reverse)
    ]
    assert asked[0] == asked[1]


def test_there_must_be_a_grid_with_elites():
    with pytest.raises(ArchiveError, match="'b' has no grid yet"):
        MESEmitter(archive_with([True]), "b", Marking()).ask(1, rng=np.random.default_rng(0))
    with pytest.raises(SelectionError, match="but got 1 from 0"):
        MESEmitter(archive_with([]), "a", Marking()).ask(1, rng=np.random.default_rng(0))
