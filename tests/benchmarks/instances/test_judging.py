"""Judging an archive by instances."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.instances import fingerprint, provenance
from benchmarks.instances import judging as module
from benchmarks.instances.candidates import candidates_of
from benchmarks.instances.judged_run import InstancesError, JudgedRun, RunLabel, check_labels
from benchmarks.instances.judgement import FilterFigures, Judgement
from benchmarks.instances.judging import Judging
from benchmarks.instances.store import JudgementStore
from benchmarks.tables.machine import describe_machine
from lqd_envs import get_task, rollout
from lqd_envs.instances import KINDS, Instance, JointBand, generate_instances
from lqd_search.runs.run_config import installed_versions

FAUCET = get_task("LQD/Faucet-v0")
OPENED = Instance(FAUCET.id, predicate=JointBand("hot_tap", 0.3, 2.1))


def judgements(path, instances, *, cap=100):
    judging = Judging(JudgedRun.read(path), cap=cap, threads=1)
    by_name = {instance.name: instance for instance in instances}
    return {by_name[judgement.instance]: judgement for judgement in judging.judge(instances)}


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
            which, solve = figures.looked_at.masks()
            assert np.array_equal(which, rows)
            assert np.array_equal(solve, solved & rows)
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
    # Two drawn, and all that selectors choose beside them.
    assert own.looked_at.motions == 7
    assert own.looked_at.solving == solved.sum()
    assert own.capped
    assert not shared.capped


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


def test_an_archive_without_elites_can_be_judged(make_run):
    wanted = [OPENED, *generate_instances(FAUCET, "change", count=1, seed=0)]

    found = judgements(make_run(rows=slice(0, 0)), wanted)

    for judgement in found.values():
        assert not judgement.solved
        assert judgement.filters["expert"].looked_at.motions == 0
        assert Judgement.from_json(judgement.to_json()) == judgement


def test_subsets_are_counted_by_hand(make_run):
    run = JudgedRun.read(make_run())
    candidates = candidates_of(run.archive, cap=100, seed=0)["inferred"]
    solved = np.zeros(8, bool)
    solved[4] = True

    figures = FilterFigures.of(
        candidates, solved, judged=candidates.rows, evaluation=run.archive.fields["evaluation"]
    )

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


def test_a_judgement_says_on_what_it_was_made_and_how_long_it_took(make_run, monkeypatch):
    clock = iter(range(0, 100, 6))
    monkeypatch.setattr(module, "perf_counter", lambda: next(clock))
    monkeypatch.setattr(provenance, "describe_commit", lambda: "a commit")
    shared = generate_instances(FAUCET, "approach", count=3, seed=0)
    own = generate_instances(FAUCET, "change", count=1, seed=0)

    found = judgements(make_run(), [*own, *shared])

    made = {instance.kind: judgement.provenance for instance, judgement in found.items()}
    # Three share a simulation.
    assert {kind: one.seconds for kind, one in made.items()} == {"approach": 2.0, "change": 6.0}
    for one in made.values():
        assert one.threads == 1
        assert one.machine == describe_machine()
        assert one.commit == "a commit"
        assert one.versions == installed_versions()


@pytest.mark.parametrize("key", ["which", "which_solve"])
@pytest.mark.parametrize("bits", ["no base64", "AAAA", "eJxjYAAAAAIAAQ=="])
def test_damaged_bits_are_one_sentence(make_run, key, bits):
    (judgement,) = judgements(make_run(), [OPENED]).values()
    plain = json.loads(judgement.to_json())
    plain["filters"]["expert"]["looked_at"][key] = bits

    with pytest.raises(InstancesError, match=r"cannot be read \(.*\); delete the file, and it is"):
        Judgement.from_json(json.dumps(plain))


@pytest.mark.parametrize("text", ["{", "[]", '{"cap": 3}'])
def test_a_damaged_judgement_is_one_sentence(text):
    with pytest.raises(InstancesError, match=r"cannot be read \(.*\); delete the file, and it is"):
        Judgement.from_json(text)


def test_a_store_gives_back_what_it_kept_with_the_same_cap_alone(make_run, tmp_path):
    (judgement,) = judgements(make_run(), [OPENED]).values()
    store = JudgementStore(tmp_path / "out", 100)
    assert store.load(judgement.run) == {}

    store.keeping(judgement.run)(judgement)

    assert store.load(judgement.run) == {OPENED.name: judgement}
    assert store.runs() == [judgement.run]
    assert JudgementStore(tmp_path / "out", 50).load(judgement.run) == {}


def test_a_store_keeps_one_judgement_of_each_instance(make_run, tmp_path):
    instances = generate_instances(FAUCET, "predicate", count=2, seed=0)
    one, other = judgements(make_run(), instances).values()
    store = JudgementStore(tmp_path, 100)

    for judgement in (one, other, replace(one, different=3)):
        store.keeping(judgement.run)(judgement)

    assert store.load(one.run) == {one.instance: replace(one, different=3), other.instance: other}


def test_equal_judgements_are_equal_files(make_run, tmp_path):
    instances = generate_instances(FAUCET, "predicate", count=2, seed=0)
    one, other = judgements(make_run(), instances).values()
    for name, order in {"a": (one, other), "b": (other, one)}.items():
        for judgement in order:
            JudgementStore(tmp_path / name, 100).keeping(judgement.run)(judgement)

    first, second = sorted(tmp_path.glob("[ab]/judged/*"))
    assert first.name == second.name
    assert first.read_bytes() == second.read_bytes()


def test_a_judgement_with_other_declarations_is_none(make_run, tmp_path, monkeypatch):
    (judgement,) = judgements(make_run(), [OPENED]).values()
    JudgementStore(tmp_path / "out", 100).keeping(judgement.run)(judgement)

    monkeypatch.setattr(fingerprint, "SIZES", (*fingerprint.SIZES, 100_000))

    assert JudgementStore(tmp_path / "out", 100).load(judgement.run) == {}


def test_a_file_of_another_run_is_refused(make_run, tmp_path):
    one, other = (
        next(iter(judgements(make_run(name, seed=seed), [OPENED]).values()))
        for name, seed in (("a", 1), ("b", 2))
    )
    store = JudgementStore(tmp_path, 100)
    store.keeping(one.run)(one)
    (path,) = (tmp_path / "judged").iterdir()
    path.rename(path.with_name(f"{other.run.name}.jsonl.gz"))

    with pytest.raises(
        InstancesError, match=rf"but got what {re.escape(one.run.name)} did; delete"
    ):
        store.load(other.run)


@pytest.mark.parametrize("cut", [0, 5, -5])
def test_a_damaged_file_is_one_sentence(make_run, tmp_path, cut):
    (judgement,) = judgements(make_run(), [OPENED]).values()
    store = JudgementStore(tmp_path, 100)
    store.keeping(judgement.run)(judgement)
    (path,) = (tmp_path / "judged").iterdir()
    path.write_bytes(b"{}" if cut == 0 else path.read_bytes()[:cut])

    with pytest.raises(InstancesError, match=r"Expected judgements in \S+, but it cannot be read"):
        store.load(judgement.run)


def test_two_do_not_judge_in_the_same_folder(tmp_path):
    store = JudgementStore(tmp_path, 100)
    with (
        store.alone(),
        pytest.raises(InstancesError, match=r"the only one that judges in \S+, .*; wait until it"),
        store.alone(),
    ):
        pass

    with store.alone():
        assert (tmp_path / "judged").is_dir()


def test_what_another_version_wrote_beside_is_left_out(make_run):
    (judgement,) = judgements(make_run(), [OPENED]).values()
    plain = json.loads(judgement.to_json())
    for part in (plain, plain["run"], plain["provenance"], plain["filters"]["expert"]):
        part["new"] = 1
    plain["filters"]["expert"]["looked_at"]["new"] = 1

    assert Judgement.from_json(json.dumps(plain)) == judgement


def test_a_run_of_no_method_is_refused(make_run):
    with pytest.raises(
        InstancesError, match=r"one of ours, .* in \S+, but it is of one_grid; leave"
    ):
        RunLabel.read(make_run(method="one_grid"))


def test_a_run_without_an_archive_is_not_finished(make_run):
    path = make_run()
    (path / "archive.npz").unlink()

    with pytest.raises(InstancesError, match=r"Expected a finished run in \S+, but its archive"):
        RunLabel.read(path)


def test_the_same_run_twice_is_refused(make_run):
    label = RunLabel.read(make_run())

    with pytest.raises(InstancesError, match="is there twice; name it once"):
        check_labels([label, label])


@pytest.mark.parametrize(
    ("name", "values", "called"),
    [
        ("evaluations", (100, 200), "evaluations"),
        ("batch_size", (10, 20), "sizes of a generation"),
        ("failure_competition", ("fitness", "coin"), "failure competition"),
    ],
)
def test_runs_of_different_methods_that_are_not_alike_are_refused(make_run, name, values, called):
    labels = [
        RunLabel.read(make_run(method, method=method, settings={name: value}))
        for method, value in zip(("ours", "random"), values, strict=True)
    ]

    expected = (
        rf"Expected runs on LQD/Faucet-v0 with equal {called}, but faucet\.ours\.\S+ has "
        rf"{values[0]} and faucet\.random\.\S+ has {values[1]}; compare them apart"
    )
    with pytest.raises(InstancesError, match=expected):
        check_labels(labels)


def test_runs_of_a_method_with_other_switches_are_refused(make_run):
    plain = RunLabel.read(make_run("plain"))
    one, other = (
        RunLabel.read(make_run(str(i), method="ours_plus", seed=i, settings={"switches": switches}))
        for i, switches in enumerate(((), ("line",)))
    )
    check_labels([plain, other])

    with pytest.raises(InstancesError, match=r"with equal switches, but .* none and .* has line;"):
        check_labels([plain, one, other])


def test_two_archives_of_the_same_run_are_refused_by_name(make_run, tmp_path):
    one, other = (RunLabel.read(make_run(n, rows=slice(0, k))) for n, k in (("a", 4), ("b", 5)))
    another_seed = RunLabel.read(make_run("c", rows=slice(0, 5), seed=10))
    store = JudgementStore(tmp_path, 100)
    store.check_archives([one, another_seed])
    both = f"but there are {re.escape(one.name)} and {re.escape(other.name)}"

    with pytest.raises(InstancesError, match=rf"{both} of the same task.*; name one of them alone"):
        store.check_archives([one, other])

    judged = tmp_path / "judged" / f"{one.name}.jsonl.gz"
    judged.parent.mkdir()
    judged.touch()
    where = re.escape(str(judged))
    with pytest.raises(InstancesError, match=rf"{both}.*; keep one of them, .* other \({where}\)"):
        store.check_archives([one, other])
    store.check_archives([one])
    with pytest.raises(
        InstancesError, match=rf"{re.escape(other.name)} and .*; delete {where}, or"
    ):
        store.check_archives([other])
