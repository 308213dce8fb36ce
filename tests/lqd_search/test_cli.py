import csv
import json
import re
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import lqd_llm
from lqd_envs import rollout
from lqd_llm import FunctionSource, build_function
from lqd_search.cli.main import lqd, main
from lqd_search.cli.run import default_batch_size
from lqd_search.runs.replay import replay
from lqd_search.runs.stored_archive import StoredArchive

SIZE = ("--evaluations", "640", "--batch-size", "32")


def run_main(capsys, *arguments: object) -> tuple[int, str, str]:
    """Run the command as a shell would; return exit status, standard output and standard error."""
    status = 0
    try:
        main([str(argument) for argument in arguments])
    except SystemExit as stop:
        status = int(stop.code or 0)
    output = capsys.readouterr()
    return status, output.out, output.err


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("runs") / "one"
    result = CliRunner().invoke(
        lqd, ["run", "LQD/Faucet-v0", *SIZE, "--seed", "4", "--threads", "1", "--out", str(folder)],
        catch_exceptions=False,
    )  # fmt: skip
    assert result.exit_code == 0
    return folder, result.output


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


def test_show_json_has_what_scripts_need_and_its_counts_add_up(run, capsys):
    folder, _ = run

    status, out, _ = run_main(capsys, "show", folder, "--json")

    figures = json.loads(out)
    assert status == 0
    assert figures["task"] == "LQD/Faucet-v0"
    assert figures["method"] == "ours"
    assert figures["seed"] == 4
    assert figures["evaluations"] == 640
    failed = sum(figures["rejected"].values()) + sum(figures["discarded"].values())
    assert figures["valid"] + failed == 640
    assert sum(figures["confusion"].values()) == figures["valid"]
    archive = StoredArchive.load(folder / "archive.npz")
    assert figures["archive_size"] == len(archive)
    assert figures["success_archive_size"] == archive.fields["expert"].sum()
    assert figures["ground_truth_cells"] <= figures["success_archive_size"]


def test_show_prints_a_table(run, capsys):
    status, out, _ = run_main(capsys, "show", run[0])

    assert status == 0
    for words in ("evaluations", "rejected", "discarded", "valid", "ground-truth cells"):
        assert words in out


def test_metrics_have_a_row_a_generation(run):
    with (run[0] / "metrics.csv").open() as file:
        rows = list(csv.DictReader(file))

    assert [int(row["evaluations"]) for row in rows] == list(range(32, 641, 32))
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
    text = (Path(__file__).parents[2] / "docs" / "run-folder.md").read_text("utf-8")
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


def test_the_same_seed_gives_the_same_archive_with_another_number_of_threads(run, tmp_path, capsys):
    folder = tmp_path / "two"

    status, _, _ = run_main(
        capsys, "run", "LQD/Faucet-v0", *SIZE, "--seed", 4, "--threads", 2, "--out", folder
    )

    assert status == 0
    assert (folder / "archive.npz").read_bytes() == (run[0] / "archive.npz").read_bytes()


def test_another_seed_gives_another_archive(run, tmp_path, capsys):
    folder = tmp_path / "three"

    run_main(capsys, "run", "LQD/Faucet-v0", *SIZE, "--seed", 5, "--out", folder)

    assert (folder / "archive.npz").read_bytes() != (run[0] / "archive.npz").read_bytes()


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
def test_a_replay_that_differs_from_the_run_has_status_1(run, capsys, tmp_path, changes):
    folder = changed_copy(run[0], tmp_path / "changed", **changes)

    status, out, err = run_main(capsys, "replay", folder, "--index", 1)

    assert status == 1
    assert "elite 1 of" in out
    assert re.fullmatch(
        r"lqd: Expected the motion that the run saw, but this replay differs from it: none of the "
        r"versions in config\.json differs from those here; [^\n]+\.\n",
        err,
    )


def test_a_replay_that_differs_names_the_versions_that_differ(run, capsys, tmp_path):
    folder = changed_copy(run[0], tmp_path / "changed", digest=lambda digest: digest + np.uint64(1))
    config = json.loads((folder / "config.json").read_text())
    here = dict(config["versions"])
    config["versions"] |= {"mujoco": "1.2.3", "numpy": "4.5.6"}
    (folder / "config.json").write_text(json.dumps(config))

    status, _, err = run_main(capsys, "replay", folder, "--index", 1)

    assert status == 1
    assert (
        f"other versions, mujoco 1.2.3 (here {here['mujoco']}), "
        f"numpy 4.5.6 (here {here['numpy']}); install these"
    ) in err


def test_replay_says_that_it_saw_what_the_search_saw(run, capsys):
    status, out, _ = run_main(capsys, "replay", run[0], "--index", 1)

    assert status == 0
    assert "infos equal to a batch rollout's, bit for bit: yes" in out
    assert "infos equal to those of the run, bit for bit: yes" in out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("run", "LQD/Nothing-v0"), r"known tasks are .*LQD/Faucet-v0"),
        (("run", "LQD/Faucet-v0", "--sample", "77"), r"recorded samples of 'faucet': 0, 1, 2"),
        (("run", "LQD/Faucet-v0", "--evaluations", "100", "--batch-size", "32"), "at most 5"),
        (("run", "LQD/Faucet-v0", "--evaluations", "none"), "not a valid integer"),
        (("show", "nowhere"), r"Expected a finished run in nowhere"),
        (("replay", "nowhere"), r"Expected a finished run in nowhere"),
    ],
)
def test_bad_input_is_one_sentence_and_status_2(arguments, message, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    status, out, err = run_main(capsys, *arguments)

    assert status == 2
    assert out == ""
    assert not list(tmp_path.iterdir())
    assert re.search(message, err)
    assert "Traceback" not in err


@pytest.mark.parametrize(
    ("file", "content", "command"),
    [
        ("summary.json", "{}", ("show",)),
        ("summary.json", "{}", ("show", "--json")),
        ("config.json", '{"format": 2, "what": 3}', ("show",)),
        ("archive.npz", "no archive", ("replay",)),
    ],
)
def test_a_damaged_run_folder_is_one_sentence_and_status_2(
    run, capsys, tmp_path, file, content, command
):
    shutil.copytree(run[0], tmp_path / "copy")
    (tmp_path / "copy" / file).write_text(content)

    status, out, err = run_main(capsys, *command, tmp_path / "copy")

    assert (status, out) == (2, "")
    assert re.fullmatch(r"lqd: Expected [^\n]+\.\n", err)


def test_another_key_of_the_summary_is_named(run, capsys, tmp_path):
    shutil.copytree(run[0], tmp_path / "copy")
    summary = json.loads((tmp_path / "copy" / "summary.json").read_text())
    del summary["grids"][0]["clipped"]
    (tmp_path / "copy" / "summary.json").write_text(json.dumps(summary))

    status, _, err = run_main(capsys, "show", tmp_path / "copy")

    assert status == 2
    assert "Expected the key 'grids[0].clipped'" in err


def test_an_out_with_too_long_a_name_is_refused(capsys, tmp_path):
    status, out, err = run_main(capsys, "run", "LQD/Faucet-v0", "--out", tmp_path / ("a" * 300))

    assert (status, out) == (2, "")
    assert re.fullmatch(r"lqd: Expected to write the run to [^\n]+ --out\.\n", err)


def test_the_examples_are_simulated_on_the_threads_asked_for(capsys, tmp_path, monkeypatch):
    asked = []

    def noting(task, solutions, *, threads=0):
        asked.append(threads)
        return rollout(task, solutions, threads=threads)

    monkeypatch.setattr("lqd_search.cli.run.rollout", noting)
    # The batch size is refused after the examples and before the search.
    status, _, _ = run_main(
        capsys, "run", "LQD/Faucet-v0", "--evaluations", 20, "--batch-size", 2, "--threads", 3,
        "--out", tmp_path / "run",
    )  # fmt: skip

    assert status == 2
    assert asked == [3]


def test_a_fitness_that_never_gives_a_number_is_not_explored(capsys, tmp_path, monkeypatch):
    infer = lqd_llm.infer_from_recording

    def infer_with_fault(*names, **options):
        inferred = infer(*names, **options)
        source = FunctionSource(
            name="never", description="faulty", code="def fitness(info): return None"
        )
        never = build_function(source, kind="fitness", entry="fitness")
        return replace(inferred, fitness=(never, *inferred.fitness[1:]))

    monkeypatch.setattr(lqd_llm, "infer_from_recording", infer_with_fault)
    folder = tmp_path / "run"

    status, _, _ = run_main(
        capsys, "run", "LQD/Faucet-v0", "--evaluations", 80, "--batch-size", 4, "--out", folder
    )

    figures = json.loads((folder / "summary.json").read_text())
    assert status == 0
    assert len(figures["exploration"]) == 2
    assert "never" not in figures["exploration"]
    assert any("'never'" in sentence for sentence in figures["dropped"])


def test_an_existing_out_is_refused(run, capsys):
    status, _, err = run_main(capsys, "run", "LQD/Faucet-v0", "--out", run[0])

    assert status == 2
    assert "Expected a new folder for the run" in err
    assert len(err.strip().splitlines()) == 1


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--index", "100000"), "Expected an index below"),
        (("--index", "1", "--best"), "Expected --index or --best, got both"),
        (("--index", "1", "--video", "film.txt"), "Expected the name of an .mp4 file"),
        (("--index", "1", "--video", "nowhere/film.mp4"), "a folder that does not exist"),
    ],
)
def test_bad_replays_are_refused(run, capsys, arguments, message):
    status, _, err = run_main(capsys, "replay", run[0], *arguments)

    assert status == 2
    assert message in err


def test_a_recording_that_does_not_parse_is_one_sentence_and_status_2(
    capsys, tmp_path, monkeypatch
):
    (tmp_path / "faucet-0.json").write_text('{"task": "faucet", ')
    infer = lqd_llm.infer_from_recording
    monkeypatch.setattr(
        lqd_llm,
        "infer_from_recording",
        lambda *names, **options: infer(*names, **options, directory=tmp_path),
    )

    status, _, err = run_main(capsys, "run", "LQD/Faucet-v0", "--out", tmp_path / "run")

    assert status == 2
    assert "faucet-0.json" in err
    assert len(err.strip().splitlines()) == 1
    assert not (tmp_path / "run").exists()


FAULTY = {
    "none": "def quantity(info): return None if info['gripper_position'][2] > 0.1 else (1.0, 2.0)",
    "nan": "def quantity(info): return (1.0, math.nan if info['gripper_position'][2] > 0.1 else 0)",
    "longer": "def quantity(info): return (1.0,) * (2 + (info['gripper_position'][2] > 0.1))",
}
ALWAYS_NONE = "def quantity(info): return None"


def test_a_run_goes_on_without_the_values_of_faulty_functionals(capsys, tmp_path, monkeypatch):
    infer = lqd_llm.infer_from_recording

    def infer_with_faults(*names, **options):
        inferred = infer(*names, **options)
        faulty = [
            build_function(
                FunctionSource(name=name, description="faulty", code=code),
                kind="quantities",
                entry="quantity",
            )
            for name, code in {**FAULTY, "never": ALWAYS_NONE}.items()
        ]
        return replace(inferred, quantities=(*inferred.quantities[:1], *faulty))

    monkeypatch.setattr(lqd_llm, "infer_from_recording", infer_with_faults)
    folder = tmp_path / "run"

    status, _, err = run_main(capsys, "run", "LQD/Faucet-v0", *SIZE, "--out", folder)

    figures = json.loads((folder / "summary.json").read_text())
    words = " ".join(err.split())
    assert status == 0
    assert figures["evaluations"] == 640
    refused = {row["functional"]: row for row in figures["refused"]}
    assert refused.keys() == FAULTY.keys()
    for name in FAULTY:
        assert refused[name]["count"] > 0
        assert f"the quantity function '{name}' returned" in words
    assert "for motion" in words
    assert any("'never'" in sentence for sentence in figures["dropped"])


@pytest.mark.parametrize(
    ("evaluations", "batch"), [(102_400, 2_048), (20_480, 512), (8_192, 256), (640, 16), (5, 1)]
)
def test_smaller_scales_keep_the_number_of_generations_up(evaluations, batch):
    assert default_batch_size(evaluations) == batch


def test_help_names_the_commands(capsys):
    status, out, _ = run_main(capsys, "--help")

    assert status == 0
    for command in ("run", "show", "replay"):
        assert command in out


def test_fifty_elites_are_replayed_bit_for_bit(run):
    fields = StoredArchive.load(run[0] / "archive.npz").fields
    rows = np.linspace(0, len(fields["solution"]) - 1, 50).round().astype(int)
    assert len(set(rows)) == 50

    for row in rows:
        shown = replay("LQD/Faucet-v0", fields["solution"][row])

        assert shown.same_as_batch
        assert shown.digest == fields["digest"][row]
        assert shown.success == fields["expert"][row]
