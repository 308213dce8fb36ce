"""`lqd adapt`."""

import json
import re
import shutil
from dataclasses import replace

import numpy as np
import pytest

from lqd_envs import get_task, rollout
from lqd_envs.instances import KINDS, Instance, JointBand, generate_instances
from lqd_search.adaptation import SELECTORS
from lqd_search.runs.stored_archive import StoredArchive

FAUCET = get_task("LQD/Faucet-v0")
# One that the tiny run has motions for.
NUMBERS = {"predicate": 2, "obstacles": 1, "approach": 2, "change": 2}
UNSOLVED = "approach:0"


@pytest.fixture(autouse=True)
def no_display(monkeypatch):
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)


@pytest.mark.parametrize("selector", SELECTORS)
@pytest.mark.parametrize("kind", KINDS)
def test_it_finds_motions_that_solve_an_instance_of_each_class(run, call, kind, selector):
    number = NUMBERS[kind]
    instance = generate_instances(FAUCET, kind, count=number + 1, seed=0)[number]
    fields = StoredArchive.load(run[0] / "archive.npz").fields

    status, out, err = call(
        *("adapt", run[0], "--instance", f"{kind}:{number}", "--selector", selector),
        *("--limit", 40, "--threads", 1),
    )

    assert (status, err) == (0, "")
    assert out.startswith(f"instance {instance.name}\n  ")
    approved = int(fields["success"].sum())
    assert f"tried 40 of the {approved} motions that the inferred condition approves" in out
    found, tries = map(int, re.search(r"(\d+) of them solves?.* after (\d+) tr", out).groups())
    assert 1 <= tries <= 40 - found + 1
    elite = int(re.search(r"^elite (\d+) of", out, re.MULTILINE)[1])
    assert fields["success"][elite]
    assert rollout(instance.apply(FAUCET), fields["solution"][[elite]]).success().all()
    assert "solved, step by step in the env: yes" in out
    assert "infos equal to a batch rollout's, bit for bit: yes" in out


def test_the_number_of_tries_is_that_of_the_first_one_in_order_of_fitness(run, call):
    fields = StoredArchive.load(run[0] / "archive.npz").fields
    instance = generate_instances(FAUCET, "obstacles", count=1, seed=0)[0]
    approved = np.flatnonzero(fields["success"])
    order = approved[np.argsort(-fields["objective"][approved], kind="stable")][:20]
    solved = rollout(instance.apply(FAUCET), fields["solution"][order]).success()

    _, out, _ = call(
        "adapt", run[0], "--instance", "obstacles", "--selector", "best", "--limit", 20
    )

    tries = int(np.argmax(solved)) + 1
    assert f"{solved.sum()} of them solve the instance, the first after {tries} tries\n" in out
    listed = ", ".join(map(str, order[solved][:10]))
    assert f"in this order, elites {listed}" in out


def test_where_none_solves_it_the_status_is_1(run, call, tmp_path):
    status, out, err = call(
        *("adapt", run[0], "--instance", UNSOLVED, "--limit", 5, "--out", tmp_path / "found.json")
    )

    assert status == 1
    assert "tried 5 of the" in out
    assert "elite" not in out
    assert re.fullmatch(
        r"lqd: Expected a motion that solves faucet-approach-\w+, but none of 5 does; raise "
        r"--limit, choose another --selector or search longer\.\n",
        err,
    )
    assert list(tmp_path.iterdir()) == []


def test_where_all_were_tried_a_higher_limit_is_no_advice(run, call):
    status, _, err = call("adapt", run[0], "--instance", UNSOLVED, "--limit", 1000)

    assert status == 1
    assert "search longer, or with another method.\n" in err


def test_an_instance_can_be_a_file_and_the_solution_is_kept(run, call, tmp_path):
    instance = Instance(FAUCET.id, predicate=JointBand("hot_tap", 0.3142, 2.1))
    (tmp_path / "mine.json").write_text(instance.to_json())
    out_file = tmp_path / "found.json"

    status, out, _ = call(
        "adapt", run[0], "--instance", tmp_path / "mine.json", "--out", out_file, "--limit", 8
    )

    assert status == 0
    assert f"kept in: {out_file}\n" in out
    kept = json.loads(out_file.read_text())
    assert Instance.from_dict(kept["instance"]) == instance
    assert (kept["task"], kept["selector"], kept["method"]) == (FAUCET.id, "diverse", "ours")
    assert kept["solving"][0] == kept["elite"]
    assert f"in this order, elites {', '.join(map(str, kept['solving'][:10]))}" in out
    solution = np.array([kept["solution"]])
    fields = StoredArchive.load(run[0] / "archive.npz").fields
    assert np.array_equal(solution[0], fields["solution"][kept["elite"]])
    assert instance.solved_by(rollout(FAUCET, solution)).all()


def test_a_video_shows_it_in_the_instance(run, call, tmp_path, monkeypatch):
    asked = []

    def play(instance, solution, *, render_mode):
        asked.append((instance, render_mode))
        return original(instance, solution)

    from lqd_search.cli import adapt

    original = adapt.replay_in
    monkeypatch.setattr(adapt, "replay_in", play)
    written = []
    monkeypatch.setattr(adapt, "write_video", lambda path, frames: written.append((path, frames)))
    film = tmp_path / "film.mp4"

    status, out, _ = call("adapt", run[0], "--instance", "change:2", "--limit", 20, "--video", film)

    assert status == 0
    assert asked == [(generate_instances(FAUCET, "change", count=3, seed=0)[2], "rgb_array")]
    assert written == [(film, ())]
    assert f"video: {film}\n" in out


def test_a_list_names_instances_and_what_they_ask(run, call):
    status, out, err = call("adapt", run[0], "--list")

    assert (status, err) == (0, "")
    for kind in KINDS:
        for i, instance in enumerate(generate_instances(FAUCET, kind, count=3, seed=0)):
            assert f"{kind}:{i}  {instance.name}\n  " in out
    assert "must not touch" in out


def test_what_the_expert_says_changes_nothing(run, call, tmp_path):
    shutil.copytree(run[0], tmp_path / "copy")
    archive = StoredArchive.load(run[0] / "archive.npz")
    fields = dict(archive.fields)
    fields["expert"] = ~fields["expert"]
    fields["ground_truth"] = np.zeros_like(fields["ground_truth"])
    (tmp_path / "copy" / "archive.npz").write_bytes(StoredArchive(fields, archive.grids).to_bytes())

    outs = [
        call("adapt", folder, "--instance", "predicate:1", "--limit", 20, "--selector", "diverse")
        for folder in (run[0], tmp_path / "copy")
    ]

    assert outs[0] == outs[1]


def test_where_the_expert_steered_the_run_it_is_his_condition_that_approves(run, call, tmp_path):
    shutil.copytree(run[0], tmp_path / "copy")
    config = json.loads((run[0] / "config.json").read_text())
    steered = config | {"method": "handcrafted", "llm": "none"}
    (tmp_path / "copy" / "config.json").write_text(json.dumps(steered))

    (_, out, _), (_, inferred, _) = (
        call("adapt", folder, "--instance", "predicate:1", "--limit", 5)
        for folder in (tmp_path / "copy", run[0])
    )

    assert re.search(r"tried 5 of the \d+ motions that the expert's condition approves, ", out)
    assert re.search(r"tried 5 of the \d+ motions that the inferred condition approves, ", inferred)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((), r"Expected an instance, but got none; name one with --instance FILE\|KIND"),
        (("--instance", "obstacle:1"), "KIND is one of predicate, obstacles, approach, change, "),
        (("--instance", "change:-1"), r"but got 'change:-1', which as a file cannot be read"),
        (("--instance", f"change:{'9' * 5000}"), "which as a file cannot be read"),
        (("--instance", f"change:0:{'9' * 5000}"), "which as a file cannot be read"),
        (("--instance", "change:10000"), "the number of a drawn instance below 10,000, but got"),
        (("--instance", "change", "--video", "film.txt"), "Expected the name of an .mp4 file"),
        (
            ("--instance", "change", "--video", "one.mp4", "--out", "one.mp4"),
            "Expected two files, but --video and --out are both one.mp4; choose another name",
        ),
        (("--instance", "change", "--out", "taken"), "in taken, but it exists already; choose"),
        (
            ("--instance", "change", "--out", "no/where"),
            "but it is in a folder that does not exist; choose",
        ),
        (("--instance", "taken"), "taken: Expected an instance as JSON, but got text that is none"),
        (("--instance", "binary"), r"cannot be read \(it is no text\)"),
        (("--instance", "other.json"), "Expected an instance of LQD/Faucet-v0, but got one of"),
    ],
)
def test_bad_input_is_one_sentence_and_status_2(
    run, call, tmp_path, monkeypatch, arguments, message
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "taken").write_text("no instance")
    (tmp_path / "binary").write_bytes(b"\xff\xfe\x00")
    (tmp_path / "other.json").write_text(Instance("LQD/Push-v0").to_json())

    status, out, err = call("adapt", run[0], *arguments)

    assert (status, out) == (2, "")
    assert re.search(message, err)
    assert "Traceback" not in err


def test_an_archive_without_a_success_is_one_sentence(run, call, tmp_path):
    shutil.copytree(run[0], tmp_path / "copy")
    archive = StoredArchive.load(run[0] / "archive.npz")
    fields = {**archive.fields, "success": np.zeros(len(archive), bool)}
    (tmp_path / "copy" / "archive.npz").write_bytes(StoredArchive(fields, archive.grids).to_bytes())

    status, _, err = call("adapt", tmp_path / "copy", "--instance", "change")

    assert status == 2
    assert re.fullmatch(r"lqd: Expected a success in the archive, but none [^\n]+\n", err)


@pytest.mark.parametrize("difference", [{"same_as_batch": False}, {"success": False}])
def test_what_the_env_shows_otherwise_is_not_kept(run, call, tmp_path, monkeypatch, difference):
    from lqd_search.cli import adapt

    original = adapt.replay_in
    monkeypatch.setattr(
        adapt, "replay_in", lambda *a, **_: replace(original(*a, render_mode=None), **difference)
    )

    status, out, err = call(
        *("adapt", run[0], "--instance", "change:2", "--limit", 20, "--threads", 0),
        *("--out", tmp_path / "found.json", "--video", tmp_path / "film.mp4"),
    )

    assert status == 1
    assert ": no\n" in out
    assert "kept in" not in out
    assert re.fullmatch(r"lqd: Expected the env to show the motion [^\n]+ names\.\n", err)
    assert list(tmp_path.iterdir()) == []


def test_the_help_names_both_meanings_of_status_1(call):
    _, out, _ = call("adapt", "--help")

    assert "exit status is 1 where none solves it, and where the env shows another motion" in (
        " ".join(out.split())
    )
