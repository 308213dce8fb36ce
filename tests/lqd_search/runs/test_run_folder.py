import errno
import json
import os
import shutil
from dataclasses import replace

import numpy as np
import pytest

from lqd_search.runs.function_text import FunctionText
from lqd_search.runs.functionals_folder import FunctionalsFolderError
from lqd_search.runs.new_folder import refuse_existing
from lqd_search.runs.run_config import RunConfig
from lqd_search.runs.run_folder import RunFolder
from lqd_search.runs.run_folder_error import RunFolderError
from lqd_search.runs.stored_archive import StoredArchive, StoredArchiveError
from lqd_search.runs.stored_outcomes import OutcomeError


def config() -> RunConfig:
    return RunConfig(
        task="LQD/Faucet-v0",
        instruction="Turn on the hot water",
        method="ours",
        seed=3,
        sample=1,
        evaluations=640,
        batch_size=32,
        explored=3,
        failure_competition="fitness",
        llm="folder",
        prompt_hashes={"success": "abc"},
        model="none",
        provenance="written by hand",
        functionals="def",
        lengths={"place": 3},
        dropped=("one sentence",),
        usage={"requests": 5, "cost": None},
    )


SUCCESS = FunctionText("success", "success", "Whether\nit is done.", "def success(infos): ...\n")
FITNESS = FunctionText("fitness", "nearness", "How near.", "def fitness(info):\n    return 0.0\n\n")


@pytest.fixture
def folder(tmp_path):
    return RunFolder.create(
        tmp_path / "runs" / "one", config=config(), functionals=[SUCCESS, FITNESS]
    )


def test_the_configuration_survives(folder):
    assert RunFolder.open(str(folder.path)).config() == config()


def test_versions_of_all_that_can_change_a_result_are_kept(folder):
    versions = json.loads((folder.path / "config.json").read_text())["versions"]

    assert set(versions) >= {"python", "mujoco", "numpy", "ribs", "gymnasium-robotics", "scipy"}


def test_functionals_are_kept_as_text_in_their_order(folder):
    files = {file.name: file.read_text() for file in (folder.path / "functionals").glob("*.py")}

    assert files == {
        "success.py": "# Whether it is done.\ndef success(infos): ...\n",
        "fitness.nearness.py": "# How near.\ndef fitness(info):\n    return 0.0\n",
    }
    assert folder.functionals() == (SUCCESS, FITNESS)


def test_where_the_expert_steers_there_are_no_functionals(tmp_path):
    expert = replace(config(), functionals="")
    folder = RunFolder.create(tmp_path / "run", config=expert, functionals=[])

    assert folder.functionals() == ()
    assert not (folder.path / "functionals").exists()


def test_what_was_asked_and_answered_is_copied(tmp_path):
    asked = tmp_path / "asked"
    asked.mkdir()
    (asked / "one.json").write_text("{}")
    folder = RunFolder.create(
        tmp_path / "run", config=config(), functionals=[SUCCESS], inference=asked
    )

    assert (folder.path / "inference" / "one.json").read_text() == "{}"
    assert (asked / "one.json").exists()


def test_a_functional_that_cannot_have_a_file_makes_no_folder(tmp_path):
    with pytest.raises(
        FunctionalsFolderError, match=r"as the name of a fitness, but got '../near'"
    ):
        RunFolder.create(
            tmp_path / "run", config=config(), functionals=[replace(FITNESS, name="../near")]
        )

    assert list(tmp_path.iterdir()) == []


def test_an_existing_folder_is_never_written_into(folder):
    with pytest.raises(RunFolderError, match=r"Expected a new folder for the run, but .* exists"):
        RunFolder.create(folder.path, config=config(), functionals=[])


def test_a_link_to_nothing_is_something_that_exists(tmp_path):
    (tmp_path / "link").symlink_to(tmp_path / "nothing")

    with pytest.raises(RunFolderError, match=r"Expected a new folder for the run, but .* exists"):
        refuse_existing(tmp_path / "link")


def test_a_name_that_is_too_long_is_one_sentence(tmp_path):
    with pytest.raises(
        RunFolderError, match=r"^Expected to write .* \(File name too long\)[^\n]*$"
    ):
        refuse_existing(tmp_path / ("a" * 300))


def test_a_parent_without_permission_is_one_sentence(tmp_path, monkeypatch):
    def forbidden(path):
        raise PermissionError(13, "Permission denied", str(path))

    # Where tests run as root, no real folder would refuse it.
    monkeypatch.setattr("pathlib.Path.lstat", forbidden)

    with pytest.raises(RunFolderError, match=r"that failed \(Permission denied\); choose a folder"):
        refuse_existing(tmp_path / "run")


def test_a_file_in_the_way_is_named(tmp_path):
    (tmp_path / "file").write_text("")

    with pytest.raises(RunFolderError, match=r"Expected to write the run to .*file"):
        RunFolder.create(tmp_path / "file" / "run", config=config(), functionals=[])


def test_a_file_is_written_whole_or_not_at_all(folder, monkeypatch):
    folder.write("summary.json", b"{}")
    monkeypatch.setattr("pathlib.Path.replace", _full_disk)

    with pytest.raises(RunFolderError, match=r"Expected to write .*summary\.json.*no space left"):
        folder.write("summary.json", b'{"half": ')

    assert (folder.path / "summary.json").read_bytes() == b"{}"
    assert {file.name for file in folder.path.iterdir() if file.is_file()} == {
        "config.json",
        "summary.json",
    }


def _full_disk(*_):
    raise OSError("no space left")


def test_a_folder_that_vanishes_in_the_middle_of_a_run_is_one_sentence(folder, make_metrics):
    shutil.rmtree(folder.path)

    for write in (
        lambda: folder.metrics.append(make_metrics()),
        lambda: folder.metrics.write([]),
        lambda: folder.write("archive.npz", b"content"),
    ):
        with pytest.raises(
            RunFolderError,
            match=r"^Expected to write \S+, but that failed \(No such[^\n]*, then go on with `lqd "
            r"run --resume \S+`: what was finished is kept\.$",
        ):
            write()


def entries(path):
    return sorted(str(entry.relative_to(path)) for entry in path.rglob("*"))


@pytest.mark.parametrize("call", ["os.fsync", "os.replace", "os.rename", "os.mkdir"])
def test_nothing_is_left_where_a_folder_cannot_be_made(tmp_path, monkeypatch, call):
    (tmp_path / "runs").mkdir()

    def full(*_, **__):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(call, full)
    with pytest.raises(
        RunFolderError,
        match=r"write the run to \S+one, but that failed \(No space left on device\); ",
    ):
        RunFolder.create(tmp_path / "runs" / "one", config=config(), functionals=[SUCCESS])
    assert entries(tmp_path) == ["runs"]


def test_nothing_is_left_where_the_user_stops_it(tmp_path, monkeypatch):
    def stop(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr("os.rename", stop)
    with pytest.raises(KeyboardInterrupt):
        RunFolder.create(tmp_path / "one", config=config(), functionals=[SUCCESS])
    assert entries(tmp_path) == []


@pytest.mark.parametrize("code", [errno.EACCES, errno.EROFS])
def test_a_parent_that_cannot_be_written_is_one_sentence(tmp_path, monkeypatch, code):
    def refuse(*_, **__):
        raise OSError(code, os.strerror(code))

    # Where tests run as root, no real folder would refuse it.
    monkeypatch.setattr("os.mkdir", refuse)
    with pytest.raises(
        RunFolderError,
        match=rf"^Expected to write the run to \S+one, but that failed \({os.strerror(code)}\); "
        r"choose a folder that can be written with --out\.$",
    ):
        RunFolder.create(tmp_path / "one", config=config(), functionals=[])
    assert entries(tmp_path) == []


def test_a_new_folder_has_the_permissions_of_any_other(folder):
    (folder.path.parent / "other").mkdir()

    assert folder.path.stat().st_mode == (folder.path.parent / "other").stat().st_mode
    assert entries(folder.path.parent) == sorted(
        ["other", "one", *(f"one/{name}" for name in entries(folder.path))]
    )


def test_a_folder_is_finished_when_it_has_a_summary(folder):
    assert not folder.finished
    folder.write("summary.json", b"{}")
    assert folder.finished


def test_an_unfinished_run_says_so(folder):
    with pytest.raises(
        RunFolderError,
        match=r"it has not finished \(no summary\.json\); go on with `lqd run --resume \S+one`\.$",
    ):
        folder.summary()


@pytest.mark.parametrize("part", ["archive", "outcomes"])
def test_an_unfinished_run_has_no_results_yet(folder, part):
    with pytest.raises(
        RunFolderError,
        match=rf"has not finished \(no {part}\.npz\); go on with `lqd run --resume \S+one`\.$",
    ):
        getattr(folder, part)()


@pytest.mark.parametrize("part", ["archive", "outcomes"])
def test_a_finished_run_that_lost_its_results_is_damaged(folder, part):
    folder.write("summary.json", b"{}")

    with pytest.raises(
        (OutcomeError, StoredArchiveError),
        match=rf"{part}\.npz, but .* cannot be read \(No such file",
    ):
        getattr(folder, part)()


def test_a_folder_that_is_no_run_says_so(tmp_path):
    with pytest.raises(RunFolderError, match="it is not there"):
        RunFolder.open(tmp_path)


def test_a_file_is_no_run_and_is_not_to_be_restored(tmp_path):
    (tmp_path / "run.log").touch()

    with pytest.raises(RunFolderError, match=r"run in .*run\.log, but it is not there"):
        RunFolder.open(tmp_path / "run.log")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "Expected JSON in"),
        ("[]", r"Expected a JSON object in .*, got list; restore the file, or run the search"),
        ('{"task": "x"}', "it is of another form"),
        ("[" * 100_000, "Expected JSON in"),
    ],
)
def test_a_damaged_configuration_is_named(folder, text, message):
    (folder.path / "config.json").write_text(text)

    with pytest.raises(RunFolderError, match=message):
        RunFolder.open(folder.path)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"task": ["a"]}, "Expected a string at 'task', but got a list"),
        ({"seed": "3"}, "Expected an integer at 'seed', but got '3'"),
        ({"versions": {"numpy": 2}}, "Expected a string at 'versions.numpy', but got 2"),
        ({"dropped": [None]}, r"Expected a string at 'dropped\[0\]', but got None"),
        ({"prompt_hashes": 3}, "Expected an object at 'prompt_hashes', but got 3"),
        ({"format": 4.0}, "Expected an integer at 'format', but got 4.0"),
    ],
)
def test_a_configuration_with_another_value_is_named(folder, change, message):
    data = json.loads((folder.path / "config.json").read_text())
    (folder.path / "config.json").write_text(json.dumps(data | change))

    with pytest.raises(RunFolderError, match=rf"^[^\n]*of another form \({message}\)[^\n]*$"):
        RunFolder.open(folder.path)


@pytest.mark.parametrize("more", [{}, {"algorithm": "new"}, {"task": {"id": "x"}}])
def test_another_layout_is_refused(folder, more):
    data = json.loads((folder.path / "config.json").read_text())
    (folder.path / "config.json").write_text(json.dumps(data | {"format": 99} | more))

    with pytest.raises(RunFolderError, match=r"the layout 4 in .*, got 99; run the search again"):
        RunFolder.open(folder.path)


def test_versions_that_are_others_here_are_found():
    here = config()
    others = {**here.versions, "numpy": "1.0", "jax": "0.5"}
    del others["ribs"]

    assert here.changed_versions() == {}
    assert replace(here, versions=others).changed_versions() == {
        "numpy": ("1.0", here.versions["numpy"]),
        "jax": ("0.5", "none"),
        "ribs": ("none", here.versions["ribs"]),
    }


def test_an_archive_that_no_run_wrote_is_refused(folder):
    fields = {"solution": np.zeros((1, 9)), "objective": np.zeros(1), "success": np.ones(1, bool)}
    archive = StoredArchive(fields=fields | {"evaluation": np.zeros(1, np.int64)}, grids={})
    (folder.path / "summary.json").write_text("{}")
    (folder.path / "archive.npz").write_bytes(archive.to_bytes())

    with pytest.raises(StoredArchiveError, match=r"columns expert, ground_truth, digest of the el"):
        folder.archive()
