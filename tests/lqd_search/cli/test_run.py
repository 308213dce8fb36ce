"""`lqd run`."""

import csv
import re
from pathlib import Path

import numpy as np
import pytest

from lqd_envs import LQDError, rollout
from lqd_search.cli.run import default_batch_size
from lqd_search.cli.run_functionals import FunctionalsSource
from lqd_search.methods.by_name import METHODS
from lqd_search.runs.function_text import FUNCTION_KINDS
from lqd_search.runs.run_folder import RunFolder
from lqd_search.runs.stored_archive import StoredArchive

SIZE = ("--evaluations", 320, "--batch-size", 16)


def test_a_run_ends_with_its_figures_and_the_paths_of_its_pictures(run):
    folder, output = run

    assert "success archive size" in output
    pictures = sorted((folder / "pictures").iterdir())
    assert {"curves.png", "ground_truth.png"} <= {picture.name for picture in pictures}
    for picture in pictures:
        assert str(picture) in output
        assert picture.read_bytes().startswith(b"\x89PNG")


def test_there_is_a_heat_map_for_each_grid(run):
    folder, _ = run
    archive = StoredArchive.load(folder / "archive.npz")

    assert len(archive.grids) >= 4
    for name in archive.grids:
        assert (folder / "pictures" / f"grid.{name}.png").exists()


def test_results_say_that_they_rest_on_recorded_replies(run):
    assert "Replies of a Claude model" in " ".join(run[1].split())


def test_metrics_have_a_row_a_generation(run):
    with (run[0] / "metrics.csv").open() as file:
        rows = list(csv.DictReader(file))

    assert [int(row["evaluations"]) for row in rows] == list(range(16, 321, 16))
    assert rows[0]["stage"] == "first batch"
    assert rows[-1]["stage"].startswith("continuing with")


def test_the_archive_holds_what_a_rollout_of_its_solutions_gives(run):
    archive = StoredArchive.load(run[0] / "archive.npz")
    trajectories = rollout("LQD/Faucet-v0", archive.fields["solution"])

    assert trajectories.valid.all()
    np.testing.assert_array_equal(trajectories.digests(), archive.fields["digest"])
    np.testing.assert_array_equal(trajectories.success(), archive.fields["expert"])
    np.testing.assert_array_equal(trajectories.ground_truth(), archive.fields["ground_truth"])


def test_the_code_in_the_description_of_the_run_folder_runs(run, monkeypatch, capsys):
    text = (Path(__file__).parents[3] / "docs" / "run-folder.md").read_text("utf-8")
    blocks = re.findall(r"^```python\n(.*?)^```$", text, re.DOTALL | re.MULTILINE)
    monkeypatch.chdir(run[0])

    printed = []
    for block in blocks:
        exec(compile(block, "run-folder.md", "exec"), {})
        printed.append(capsys.readouterr().out)

    approved = StoredArchive.load(Path("archive.npz")).fields["expert"].sum()
    assert len(printed) == 2
    assert printed[1].startswith(f"LQD/Faucet-v0 {approved}\n")
    assert printed[1].endswith(printed[0])


def test_another_seed_gives_another_archive(call, tmp_path):
    archives = []
    for seed in (4, 5):
        folder = tmp_path / str(seed)
        call(
            "run", "LQD/Faucet-v0", "--method", "random", "--evaluations", 64, "--batch-size", 32,
            "--seed", seed, "--out", folder,
        )  # fmt: skip
        archives.append(StoredArchive.load(folder / "archive.npz"))

    assert len(archives[0]) > 9
    assert archives[0].to_bytes() != archives[1].to_bytes()


def test_an_out_with_too_long_a_name_is_refused(call, tmp_path):
    status, out, err = call("run", "LQD/Faucet-v0", "--out", tmp_path / ("a" * 300))

    assert (status, out) == (2, "")
    assert re.fullmatch(r"lqd: Expected to write the run to [^\n]+ --out\.\n", err)


def test_the_examples_are_simulated_on_the_threads_asked_for(call, tmp_path, monkeypatch):
    asked = []

    def noting(*_, threads):
        asked.append(threads)
        raise LQDError("that was all")

    monkeypatch.setattr("lqd_search.cli.checked_functionals.rollout", noting)
    status, _, err = call("run", "LQD/Faucet-v0", "--threads", 3, "--out", tmp_path / "run")

    assert (status, err) == (2, "lqd: that was all\n")
    assert asked == [3]


@pytest.mark.parametrize(
    ("method", "size", "message"),
    [
        ("ours", (10,), "a tenth of 10 makes 1 of 1; spend at least 20 evaluations"),
        ("ours_plus", (100, "--batch-size", 64), "use a batch size of at most 5"),
        ("direct", (100, "--batch-size", 64), "use a batch size of at most 5"),
        ("ga", (100, "--batch-size", 1), "a batch size of at least 2, but got 100 and 1; raise"),
    ],
)
def test_a_size_that_will_not_do_is_refused_before_anything_is_inferred(
    call, tmp_path, monkeypatch, method, size, message
):
    monkeypatch.setattr(FunctionalsSource, "get", lambda *_, **__: pytest.fail("inferred"))

    status, out, err = call(
        "run", "LQD/Faucet-v0", "--method", method, "--evaluations", *size, "--out", tmp_path / "a"
    )

    assert (status, out) == (2, "")
    assert message in err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("option", [("--effort", "low"), ("--recordings", "mine")])
def test_where_the_expert_steers_no_option_of_a_model_is_heeded(call, tmp_path, option):
    status, out, err = call(
        *("run", "LQD/Faucet-v0", "--method", "handcrafted", *option),
        *("--evaluations", 64, "--out", tmp_path / "run"),
    )

    assert (status, out) == (2, "")
    assert "neither functionals nor a model to ask with the method 'handcrafted'" in err


@pytest.mark.parametrize("method", ["random", "ga"])
def test_a_few_evaluations_are_a_run_too(call, tmp_path, method):
    status, _, err = call(
        "run", "LQD/Faucet-v0", "--method", method, "--evaluations", 6, "--out", tmp_path / "run"
    )

    assert status == 0, err
    run = RunFolder.open(tmp_path / "run")
    assert run.summary()["evaluations"] == 6
    assert run.config().batch_size == {"random": 1, "ga": 2}[method]


def test_an_existing_out_is_refused(run, call):
    status, _, err = call("run", "LQD/Faucet-v0", "--out", run[0])

    assert status == 2
    assert "Expected a new folder for the run" in err
    assert len(err.strip().splitlines()) == 1


@pytest.mark.parametrize(
    ("evaluations", "batch"), [(102_400, 2_048), (20_480, 512), (8_192, 256), (640, 16), (5, 1)]
)
def test_smaller_scales_keep_the_number_of_generations_up(evaluations, batch):
    assert default_batch_size(evaluations) == batch


def check_method(call, folder, *, task, method):
    status, out, err = call(
        "run", task, "--method", method, "--evaluations", 320, "--batch-size", 16, "--seed", 1,
        "--out", folder,
    )  # fmt: skip

    assert status == 0, err
    run = RunFolder.open(folder)
    summary, archive, outcomes = run.summary(), run.archive(), run.outcomes()
    assert (summary["method"], summary["evaluations"]) == (method, 320)
    assert f"{task} · {method} · seed 1" in out
    assert max(map(len, out.split("Run folder")[0].splitlines())) <= 80
    assert summary["archive_size"] == len(archive)
    assert summary["success_archive_size"] == archive.fields["expert"].sum()
    found = summary["outcomes"]
    assert found["both"] + found["expert_only"] == outcomes["expert"].sum()
    assert summary["expert_successes"] >= outcomes["expert"].sum() >= archive.fields["expert"].sum()
    assert [grid["name"] for grid in summary["grids"]] == list(archive.grids)
    if method in ("ga", "random"):
        assert not archive.grids
        for words in ("coverage", "clipped", "first batch"):
            assert words not in out
    if method == "handcrafted":
        assert archive.grids.keys() == {"ground_truth"}
        assert run.functionals() == ()
        assert "Steered by the expert" in out
    else:
        assert {text.kind for text in run.functionals()} == set(FUNCTION_KINDS)
    with (folder / "metrics.csv").open(newline="") as file:
        assert len(list(csv.DictReader(file))) == 20


# On the other tasks they take minutes; that the others run on this one is seen elsewhere.
@pytest.mark.parametrize(
    "method",
    [
        name if name in ("direct", "ga") else pytest.param(name, marks=pytest.mark.slow)
        for name in METHODS
    ],
)
def test_every_method_runs(call, tmp_path, monkeypatch, method):
    monkeypatch.setenv("COLUMNS", "80")
    check_method(call, tmp_path / "run", task="LQD/Faucet-v0", method=method)


@pytest.mark.slow
@pytest.mark.parametrize("task", ["LQD/Grasp-v0", "LQD/Drawer-v0", "LQD/Push-v0"])
@pytest.mark.parametrize("method", METHODS)
def test_every_method_runs_on_every_task(call, tmp_path, monkeypatch, task, method):
    monkeypatch.setenv("COLUMNS", "80")
    check_method(call, tmp_path / "run", task=task, method=method)
