"""Which motions of an archive are looked at."""

import numpy as np
import pytest

from benchmarks.instances import candidates as module
from benchmarks.instances.candidates import candidates_of
from benchmarks.instances.declared import SUBSETS
from lqd_envs import SolutionSpace
from lqd_search.adaptation import SELECTORS, NamedSelector
from lqd_search.runs.stored_archive import StoredArchive


@pytest.fixture
def archive():
    n = 60
    rng = np.random.default_rng(0)
    return StoredArchive(
        {
            "solution": SolutionSpace().sample(n, rng=rng),
            "objective": rng.permutation(n).astype(float),
            "success": rng.random(n) < 0.7,
            "evaluation": np.arange(n),
            "expert": rng.random(n) < 0.7,
            "ground_truth": rng.random((n, 1)),
            "digest": np.arange(n, dtype=np.uint64),
        },
        {},
    )


def test_filters_keep_what_their_condition_approves(archive):
    found = candidates_of(archive, cap=100, seed=0)

    for name, column in (("inferred", "success"), ("expert", "expert")):
        approved = np.flatnonzero(archive.fields[column])
        assert found[name].rows.tolist() == approved.tolist()
        assert sorted(found[name].sample) == approved.tolist()


def test_a_sample_is_no_larger_than_the_cap_and_random(archive):
    samples = [candidates_of(archive, cap=10, seed=s)["inferred"].sample for s in range(80)]

    assert {len(set(sample.tolist())) for sample in samples} == {10}
    approved = np.flatnonzero(archive.fields["success"])
    counts = np.bincount(np.concatenate(samples), minlength=60)[approved]
    # Each is in a sample with probability 10 / n: all within five standard deviations of it.
    share = 10 / len(approved)
    assert np.abs(counts - 80 * share).max() < 5 * np.sqrt(80 * share * (1 - share))
    assert counts.sum() == 800


def test_selectors_choose_from_the_whole_archive_whatever_the_cap(archive):
    few, many = (candidates_of(archive, cap=cap, seed=1)["inferred"] for cap in (3, 100))

    for name in SELECTORS:
        assert few.picks[name].tolist() == many.picks[name].tolist()
        assert len(few.picks[name]) == 20
    assert set(few.simulated) == {*few.sample, *few.picks["best"], *few.picks["diverse"]}


def test_selectors_choose_from_subsets_of_the_sample(archive):
    found = candidates_of(archive, cap=15, seed=2)["inferred"]

    for name in SELECTORS:
        by_size = found.subset_picks[name]
        assert list(by_size) == [1, 2, 5, 10]
        for size, rows in by_size.items():
            assert rows.shape == (SUBSETS, size)
            assert set(rows.ravel()) <= set(found.sample)
            assert all(len(set(row)) == size for row in rows.tolist())
    objective = archive.fields["objective"]
    best = objective[found.subset_picks["best"][10]]
    assert (np.diff(best, axis=1) < 0).all()


def test_selectors_are_handed_nothing_of_the_expert_s(archive, monkeypatch):
    seen = []

    def spy(view, count):
        seen.append(set(vars(view)))
        return SELECTORS["best"].select(view, count)

    monkeypatch.setattr(module, "SELECTORS", {"spy": NamedSelector("spy", "", spy)})

    candidates_of(archive, cap=15, seed=2)

    assert seen
    assert set().union(*seen) == {"solution", "objective", "success", "digest", "measures"}


def test_the_same_seed_draws_the_same(archive):
    one, other = (candidates_of(archive, cap=15, seed=5)["expert"] for _ in range(2))

    assert one.sample.tolist() == other.sample.tolist()
    assert np.array_equal(one.subset_picks["diverse"][5], other.subset_picks["diverse"][5])
