"""`lqd show`."""

import json
import re
import shutil

import pytest

from lqd_search.runs.stored_archive import StoredArchive


def test_show_json_has_what_scripts_need_and_its_counts_add_up(run, call):
    folder, _ = run

    status, out, _ = call("show", folder, "--json")

    figures = json.loads(out)
    assert status == 0
    assert figures["task"] == "LQD/Faucet-v0"
    assert figures["method"] == "ours"
    assert figures["seed"] == 1
    assert figures["evaluations"] == 320
    failed = sum(figures["rejected"].values()) + sum(figures["discarded"].values())
    assert figures["valid"] + failed == 320
    assert sum(figures["confusion"].values()) == figures["valid"]
    archive = StoredArchive.load(folder / "archive.npz")
    assert figures["archive_size"] == len(archive)
    assert figures["success_archive_size"] == archive.fields["expert"].sum()
    assert figures["ground_truth_cells"] <= figures["success_archive_size"]


def test_show_prints_a_table(run, call):
    status, out, _ = call("show", run[0])

    assert status == 0
    for words in ("evaluations", "rejected", "discarded", "valid", "ground-truth cells"):
        assert words in out


@pytest.mark.parametrize(
    ("file", "content", "command"),
    [
        ("summary.json", "{}", ("show",)),
        ("summary.json", "{}", ("show", "--json")),
        ("config.json", '{"format": 3, "what": 3}', ("show",)),
        ("archive.npz", "no archive", ("replay",)),
    ],
)
def test_a_damaged_run_folder_is_one_sentence_and_status_2(
    run, call, tmp_path, file, content, command
):
    shutil.copytree(run[0], tmp_path / "copy")
    (tmp_path / "copy" / file).write_text(content)

    status, out, err = call(*command, tmp_path / "copy")

    assert (status, out) == (2, "")
    assert re.fullmatch(r"lqd: Expected [^\n]+\.\n", err)


def test_another_key_of_the_summary_is_named(run, call, tmp_path):
    shutil.copytree(run[0], tmp_path / "copy")
    summary = json.loads((tmp_path / "copy" / "summary.json").read_text())
    del summary["grids"][0]["clipped"]
    (tmp_path / "copy" / "summary.json").write_text(json.dumps(summary))

    status, _, err = call("show", tmp_path / "copy")

    assert status == 2
    assert "Expected the key 'grids[0].clipped'" in err
