"""Judging an archive by instances."""

import numpy as np
import pytest

from benchmarks.instances.candidates import candidates_of
from benchmarks.instances.judged_run import InstancesError, JudgedRun, RunLabel, check_labels
from benchmarks.instances.judgement import FilterFigures, Judgement
from benchmarks.instances.judging import Judging
from benchmarks.instances.store import JudgementStore
from lqd_envs import get_task, rollout
from lqd_envs.instances import KINDS, Instance, JointBand, generate_instances

FAUCET = get_task("LQD/Faucet-v0")
OPENED = Instance(FAUCET.id, predicate=JointBand("hot_tap", 0.3, 2.1))


def judgements(path, instances, *, cap=100):
    judging = Judging(JudgedRun.read(path), cap=cap, threads=1)
    return dict(judging.judge(instances))


@pytest.mark.parametrize("kind", KINDS)
def test_the_solving_motions_are_those_of_the_simulation(make_run, fields, kind):
    instances = generate_instances(FAUCET, kind, count=3, seed=0)

    found = judgements(make_run(), instances)

    assert set(found) == set(instances)
    for instance, judgement in found.items():
        solved = rollout(instance.apply(FAUCET), fields["solution"]).success()
        approved = (fields["success"], fields["expert"])
        for by, rows in zip(("inferred", "expert"), approved, strict=True):
            figures = judgement.filters[by]
            assert (figures.motions, figures.judged) == (rows.sum(), rows.sum())
            assert figures.solved == solved[rows].sum()
            # The motions are in the order of their fitness.
            first = np.argmax(solved[rows]) + 1 if solved[rows].any() else 0
            assert figures.first["best"] == first
        assert judgement.solved == bool(solved[fields["success"] | fields["expert"]].any())
        assert judgement.different == 0


def test_a_cap_limits_what_is_drawn_but_not_what_selectors_choose(make_run, fields):
    instances = [*generate_instances(FAUCET, "change", count=1, seed=0), OPENED]

    found = judgements(make_run(), instances, cap=2)

    own, shared = (found[instance].filters["expert"] for instance in instances)
    assert (own.motions, own.judged) == (7, 2)
    assert (shared.motions, shared.judged, shared.solved) == (7, 7, 7)
    solved = rollout(instances[0].apply(FAUCET), fields["solution"][fields["expert"]]).success()
    assert own.first["best"] == (np.argmax(solved) + 1 if solved.any() else 0)


def test_motions_that_are_not_what_the_run_saw_are_counted(make_run, fields):
    digest = fields["digest"].copy()
    digest[[1, 2]] += np.uint64(1)

    found = judgements(make_run(digest=digest), [OPENED])

    assert found[OPENED].different == 2


def test_an_archive_without_a_success_solves_nothing(make_run):
    nothing = np.zeros(8, bool)

    found = judgements(
        make_run(success=nothing, expert=nothing),
        [OPENED, *generate_instances(FAUCET, "change", count=1, seed=0)],
    )

    for judgement in found.values():
        assert not judgement.solved
        assert judgement.filters["inferred"].first == {"best": 0, "diverse": 0}
        assert judgement.filters["inferred"].judged == 0


def test_subsets_are_counted_by_hand(make_run):
    run = JudgedRun.read(make_run())
    candidates = candidates_of(run.archive, cap=100, seed=0)["inferred"]
    solved = np.zeros(8, bool)
    solved[4] = True

    figures = FilterFigures.of(candidates, solved, judged=candidates.rows)

    assert figures.solved == 1
    # Rows 1 to 7 in the order of their fitness: the fourth try.
    assert figures.first["best"] == 4
    for size in (1, 2, 5):
        subsets = [set(row) for row in candidates.subset_picks["best"][size].tolist()]
        within = sum(4 in subset for subset in subsets)
        firsts = sum(min(subset) == 4 for subset in subsets)
        assert figures.subsets["best"][str(size)] == (firsts, within, within)


def test_a_judgement_is_read_as_it_was_written(make_run):
    (judgement,) = judgements(make_run(), [OPENED]).values()

    assert Judgement.from_json(judgement.to_json()) == judgement


@pytest.mark.parametrize("text", ["{", "[]", '{"cap": 3}'])
def test_a_damaged_judgement_is_one_sentence(text):
    with pytest.raises(InstancesError, match=r"cannot be read \(.*\); delete the file, and it is"):
        Judgement.from_json(text)


def test_a_store_gives_back_what_it_kept_with_the_same_cap_alone(make_run, tmp_path):
    (judgement,) = judgements(make_run(), [OPENED]).values()
    store = JudgementStore(tmp_path / "out", 100)
    assert store.load(judgement.run, OPENED) is None

    store.keep(judgement, OPENED)

    assert store.load(judgement.run, OPENED) == judgement
    assert store.runs() == [judgement.run]
    assert JudgementStore(tmp_path / "out", 50).load(judgement.run, OPENED) is None


def test_a_file_of_another_instance_is_refused(make_run, tmp_path):
    other = generate_instances(FAUCET, "predicate", count=1, seed=0)[0]
    (judgement,) = judgements(make_run(), [other]).values()
    store = JudgementStore(tmp_path / "out", 100)
    store.keep(judgement, OPENED)

    with pytest.raises(InstancesError, match=r"but got that of \S+ in faucet-predicate"):
        store.load(judgement.run, OPENED)


def test_a_run_without_an_archive_is_not_finished(make_run):
    path = make_run()
    (path / "archive.npz").unlink()

    with pytest.raises(InstancesError, match=r"Expected a finished run in \S+, but its archive"):
        RunLabel.read(path)


def test_the_same_run_twice_or_mixed_scales_are_refused(make_run):
    one, other = (RunLabel.read(make_run(n, evaluations=e)) for n, e in (("a", 100), ("b", 200)))

    with pytest.raises(InstancesError, match="is there twice; name it once"):
        check_labels([one, one])
    with pytest.raises(InstancesError, match="with equal evaluations, but got 100 and 200"):
        check_labels([one, other])
