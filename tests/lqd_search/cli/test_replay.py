"""`lqd replay`."""

import json
import re
import shutil

import numpy as np
import pytest

from lqd_search.runs.replay import replay
from lqd_search.runs.stored_archive import StoredArchive


def changed_copy(folder, path, **changes):
    """Copy a run folder and change its archive's columns by these functions."""
    shutil.copytree(folder, path)
    archive = StoredArchive.load(path / "archive.npz")
    fields = {name: changes.get(name, np.copy)(c) for name, c in archive.fields.items()}
    (path / "archive.npz").write_bytes(StoredArchive(fields, archive.grids).to_bytes())
    return path


@pytest.mark.parametrize(
    "changes",
    [{"digest": lambda digest: digest + np.uint64(1)}, {"expert": np.logical_not}],
    ids=["infos", "success"],
)
def test_a_replay_that_differs_from_the_run_has_status_1(run, call, tmp_path, changes):
    folder = changed_copy(run[0], tmp_path / "changed", **changes)

    status, out, err = call("replay", folder, "--index", 1)

    assert status == 1
    assert "elite 1 of" in out
    assert re.fullmatch(
        r"lqd: Expected the motion that the run saw, but this replay differs from it: none of the "
        r"versions in config\.json differs from those here; [^\n]+\.\n",
        err,
    )


def test_a_replay_that_differs_names_the_versions_that_differ(run, call, tmp_path):
    folder = changed_copy(run[0], tmp_path / "changed", digest=lambda digest: digest + np.uint64(1))
    config = json.loads((folder / "config.json").read_text())
    here = dict(config["versions"])
    config["versions"] |= {"mujoco": "1.2.3", "numpy": "4.5.6"}
    (folder / "config.json").write_text(json.dumps(config))

    status, _, err = call("replay", folder, "--index", 1)

    assert status == 1
    assert (
        f"other versions, mujoco 1.2.3 (here {here['mujoco']}), "
        f"numpy 4.5.6 (here {here['numpy']}); install these"
    ) in err


def test_replay_says_that_it_saw_what_the_search_saw(run, call):
    status, out, _ = call("replay", run[0], "--index", 1)

    assert status == 0
    assert "infos equal to a batch rollout's, bit for bit: yes" in out
    assert "infos equal to those of the run, bit for bit: yes" in out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--index", "100000"), "Expected an index below"),
        (("--index", "1", "--best"), "got --index and --best; leave one out."),
        (("--outcome", "0", "--best"), "got --best and --outcome; leave one out."),
        (("--outcome", "0", "--index", "0"), "got --index and --outcome; leave one out."),
        (("--outcome", "0", "--index", "0", "--best"), "--best and --outcome; leave two out."),
        (("--outcome", "100000"), "the number of outcomes, got 100000; choose a lower one."),
        (("--index", "1", "--video", "film.txt"), "Expected the name of an .mp4 file"),
        (("--index", "1", "--video", "nowhere/film.mp4"), "a folder that does not exist"),
    ],
)
def test_bad_replays_are_refused(run, call, arguments, message):
    status, _, err = call("replay", run[0], *arguments)

    assert status == 2
    assert message in err


def test_fifty_elites_are_replayed_bit_for_bit(run):
    fields = StoredArchive.load(run[0] / "archive.npz").fields
    rows = np.linspace(0, len(fields["solution"]) - 1, 50).round().astype(int)
    assert len(set(rows)) == 50

    for row in rows:
        shown = replay("LQD/Faucet-v0", fields["solution"][row])

        assert shown.same_as_batch
        assert shown.digest == fields["digest"][row]
        assert shown.success == fields["expert"][row]


def columns_of(path):
    with np.load(path / "outcomes.npz") as file:
        return {name: file[name] for name in file.files}


def test_an_outcome_is_replayed_bit_for_bit(run, call):
    outcomes = columns_of(run[0])
    row = int(np.flatnonzero(outcomes["expert"] & outcomes["success"])[-1])

    status, out, err = call("replay", run[0], "--outcome", row)

    fitness = [name for name in outcomes if name.startswith("fitness/")]
    n = len(outcomes["solution"])
    scores = [f"fitness {name[8:]} {outcomes[name][row]:.6g}" for name in fitness]
    assert (status, err) == (0, "")
    assert len(scores) > 1
    assert out.splitlines()[0] == (
        f"outcome {row} of {n}, evaluation {outcomes['evaluation'][row]}, {', '.join(scores)}"
    )
    assert "yes by the expert's condition (in the run: yes; by the inferred one: yes)" in out
    assert "infos equal to a batch rollout's, bit for bit: yes" in out
    assert "infos equal to those of the run, bit for bit: yes" in out


@pytest.mark.parametrize(
    "changes",
    [{"digest": lambda digest: digest + np.uint64(1)}, {"expert": np.logical_not}],
    ids=["infos", "success"],
)
def test_an_outcome_that_differs_from_the_run_has_status_1(run, call, tmp_path, changes):
    shutil.copytree(run[0], tmp_path / "changed")
    outcomes = columns_of(run[0])
    # Each outcome must be a success by one of both.
    (row, *_) = np.flatnonzero(outcomes["success"] & outcomes["expert"])
    for name, change in changes.items():
        outcomes[name][row] = change(outcomes[name][row])
    np.savez(tmp_path / "changed" / "outcomes.npz", **outcomes)

    status, out, err = call("replay", tmp_path / "changed", "--outcome", row)

    assert status == 1
    assert f"outcome {row} of" in out
    assert re.match("lqd: Expected the motion that the run saw, but this replay differs", err)


def test_damaged_outcomes_are_one_sentence(run, call, tmp_path):
    shutil.copytree(run[0], tmp_path / "copy")
    (tmp_path / "copy" / "outcomes.npz").write_bytes(b"no outcomes")

    status, out, err = call("replay", tmp_path / "copy", "--outcome", 0)

    assert (status, out) == (2, "")
    assert re.fullmatch(r"lqd: Expected outcomes in \S+, but they cannot be read [^\n]+\.\n", err)


@pytest.mark.parametrize(
    ("command", "part"),
    [
        (("replay",), "archive"),
        (("replay", "--outcome", 0), "outcomes"),
        (("adapt", "--instance", "change"), "archive"),
    ],
)
def test_of_an_unfinished_run_nothing_can_be_carried_out_yet(stopped, call, command, part):
    status, out, err = call(command[0], stopped[0], *command[1:])

    assert (status, out) == (2, "")
    assert re.fullmatch(
        rf"lqd: Expected a finished run in \S+, but it has not finished \(no {part}\.npz\); go on "
        r"with `lqd run --resume \S+`\.\n",
        err,
    )
