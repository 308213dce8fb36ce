"""`lqd run --resume`: going on with a run that was stopped."""

import errno
import io
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from lqd_search.runs.run_config import installed_versions
from lqd_search.runs.run_folder import RunFolder


@pytest.fixture
def copy(stopped, tmp_path):
    """Return a copy of the folder of a run that was stopped after three generations."""
    return Path(shutil.copytree(stopped[0], tmp_path / "copy"))


def results(folder):
    summary = json.loads((folder / "summary.json").read_text())
    npz = [(folder / name).read_bytes() for name in ("archive.npz", "outcomes.npz")]
    return [*npz, {**summary, "seconds": 0.0}]


def names(folder):
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*"))


def test_who_stops_a_run_is_told_how_to_go_on(stopped):
    folder, output = stopped

    last = output.strip().splitlines()[-1]
    assert last == f"lqd: stopped; go on with `lqd run --resume {folder}`"
    assert "Traceback" not in output
    assert len(RunFolder(folder).state.load().metrics) == 3


def test_a_run_that_was_stopped_ends_like_one_that_was_not(run, copy, call):
    status, out, err = call("run", "--resume", copy, "--threads", 2)

    assert status == 0
    assert f"Run folder: {copy}" in out
    assert results(copy) == results(run[0])
    assert names(copy) == names(run[0])

    # From now on its figures are shown, however often one tries.
    before = [(copy / name).stat().st_mtime_ns for name in names(copy)]
    status, again, err = call("run", "--resume", copy)
    assert status == 0
    assert err.endswith(f"note: the run in {copy} is finished; these are its figures\n")
    assert out.startswith(again)
    assert [(copy / name).stat().st_mtime_ns for name in names(copy)] == before


def test_a_run_that_is_interrupted_by_the_user_says_how_to_go_on(tmp_path, call):
    folder = tmp_path / "a run"
    arguments = ("--method", "handcrafted", "--evaluations", "160", "--batch-size", "8")
    process = subprocess.Popen(
        [sys.executable, "-m", "lqd_search", "run", "LQD/Faucet-v0", *arguments, "--out", folder],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        # Where the tests run in the background of a shell, it would be ignored.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )
    while not (folder / "checkpoint").exists():
        assert process.poll() is None, process.communicate()
        time.sleep(0.02)
    process.send_signal(signal.SIGINT)
    out, err = process.communicate()

    assert (process.returncode, out) == (130, "")
    assert "Traceback" not in err
    assert err.splitlines()[-1] == f"lqd: stopped; go on with `lqd run --resume '{folder}'`"
    assert not (folder / "summary.json").exists()

    status, _, _ = call("run", "--resume", folder)
    assert status == 0
    assert RunFolder(folder).summary()["evaluations"] == 160


@pytest.mark.parametrize(
    ("arguments", "given"),
    [
        (("LQD/Faucet-v0",), "TASK"),
        (("--seed", 4), "--seed"),
        (("--batch-size", 32, "--method", "ours"), "--batch-size, --method"),
        (("--failure-competition", "coin"), "--failure-competition"),
        (("--out", "other", "--evaluations", 640), "--out, --evaluations"),
        (("--sample", 0), "--sample"),
        (("--llm", "live", "--functionals", "."), "--llm, --functionals"),
    ],
)
def test_nothing_else_can_be_chosen_anew(copy, call, arguments, given):
    before = names(copy)

    status, out, err = call("run", "--resume", copy, *arguments)

    assert (status, out) == (2, "")
    assert err == (
        "lqd: Expected nothing but --threads, --workers and --allow-weak-sandbox beside --resume, "
        f"since a run goes on as it began, but got {given}; leave it out, or begin another run.\n"
    )
    assert names(copy) == before


def test_without_a_task_it_is_one_sentence(call):
    status, out, err = call("run")

    assert (status, out) == (2, "")
    assert err.startswith("lqd: Expected a TASK, such as LQD/Faucet-v0, or --resume DIR, but got")


def test_the_figures_of_an_unfinished_run_are_not_there_yet(stopped, call):
    for arguments in (("show",), ("show", "--json")):
        status, out, err = call(*arguments, stopped[0])

        assert (status, out) == (2, "")
        assert err == (
            f"lqd: Expected a finished run in {stopped[0]}, but it has not finished (no "
            f"summary.json); go on with `lqd run --resume {stopped[0]}`.\n"
        )


def flip(path, place):
    content = bytearray(path.read_bytes())
    content[place] ^= 0x08
    path.write_bytes(content)


DAMAGE = {
    "a truncated checkpoint": (
        lambda folder: os.truncate(folder / "checkpoint", 5_000),
        r"Expected a checkpoint in \S+checkpoint, but it cannot be read \(it has \d+ bytes after "
        r"its head instead of \d+\); restore the file, or delete it",
    ),
    "a flipped bit in the checkpoint": (
        lambda folder: flip(folder / "checkpoint", 4_321),
        r"but it cannot be read \(its bytes are others than were written\); restore the file",
    ),
    "no segment of the outcomes": (
        lambda folder: (folder / "checkpoint-outcomes" / "000002.npz").unlink(),
        r"Expected outcomes in \S+000002\.npz, but they cannot be read \(No such file or",
    ),
    "a flipped bit in the outcomes": (
        lambda folder: flip(folder / "checkpoint-outcomes" / "000001.npz", 150),
        r"Expected outcomes in \S+000001\.npz, but they cannot be read",
    ),
    "an edited functional": (
        lambda folder: (folder / "functionals" / "success.py").write_text(
            "# It.\ndef success(_): 1"
        ),
        r"Expected the functionals in \S+copy to be those that the run began with, but they were "
        r"changed; restore them, or begin another run with `lqd run LQD/Faucet-v0 --functionals ",
    ),
    "another functional": (
        lambda folder: (folder / "functionals" / "fitness.other.py").write_text("# It.\nx = 3\n"),
        r"Expected the functionals in \S+copy to be those that the run began with, but they were",
    ),
    "another order of the functionals": (
        lambda folder: (folder / "functionals" / "functionals.json").unlink(),
        r"Expected the functionals in \S+copy to be those that the run began with, but they were",
    ),
    "no condition of success": (
        lambda folder: [p.unlink() for p in (folder / "functionals").glob("*success.py")],
        r"Expected functionals with success\.py in \S+copy/functionals, but it holds",
    ),
    "an unknown method": (
        lambda folder: edit(folder, method="ours_minus"),
        r"Expected one of ours, [^\n]+ as method in the config\.json of \S+copy, but got 'ours_m",
    ),
    "another seed": (
        lambda folder: edit(folder, seed=8, batch_size=2048),
        r"Expected the config\.json of \S+copy to be as it was when the run began, but got seed 8 "
        r"instead of \d+, batch_size 2048 instead of \d+; restore it, or begin another run",
    ),
    "an unknown competition": (
        lambda folder: edit(folder, failure_competition="dice"),
        r"Expected one of fitness, coin as failure_competition in the config\.json of \S+copy",
    ),
}


def edit(folder, **changes):
    config = json.loads((folder / "config.json").read_text())
    (folder / "config.json").write_text(json.dumps(config | changes))


@pytest.mark.parametrize("harm", DAMAGE)
def test_a_damaged_run_does_not_go_on(copy, call, harm):
    damage, message = DAMAGE[harm]
    damage(copy)
    before = {path: path.read_bytes() for path in copy.rglob("*") if path.is_file()}

    status, out, err = call("run", "--resume", copy)

    assert (status, out) == (2, "")
    assert re.search(rf"^lqd: [^\n]*{message}[^\n]*\.\n\Z", err, re.MULTILINE)
    assert "Traceback" not in err
    assert {path: path.read_bytes() for path in copy.rglob("*") if path.is_file()} == before


def test_two_processes_do_not_go_on_with_the_same_run(copy, call, monkeypatch):
    with RunFolder(copy).locked():
        status, out, err = call("run", "--resume", copy)

    assert (status, out) == (2, "")
    assert err == (
        f"lqd: Expected to be the only one that goes on with the run in {copy}, but another "
        "process does; wait until it ends, or stop it.\n"
    )
    assert go_on_for_a_generation(copy, call, monkeypatch) == 4


def refuse_writes(monkeypatch, name, *, after, code):
    """Let writing to files whose path holds a name fail once that many bytes are written."""
    really_open = io.open

    def opened(file, mode="r", *arguments, **options):
        made = really_open(file, mode, *arguments, **options)
        if "r" not in mode and name in str(file):
            write = made.write

            def refuse(content):
                write(content[:after])
                raise OSError(code, os.strerror(code))

            made.write = refuse
        return made

    monkeypatch.setattr(io, "open", opened)


@pytest.mark.parametrize(
    ("name", "after", "code"),
    [
        (".checkpoint.part", 0, errno.ENOSPC),
        (".checkpoint.part", 20_000, errno.ENOSPC),
        (".checkpoint.part", 31, errno.EIO),
        (".000004.npz.part", 1_000, errno.ENOSPC),
        ("metrics.csv", 10, errno.ENOSPC),
        ("copy", 0, errno.EROFS),
        ("copy", 0, errno.EACCES),
    ],
)
def test_a_run_on_a_disk_that_cannot_be_written_stops_and_goes_on_later(
    copy, call, monkeypatch, name, after, code
):
    checkpoint = (copy / "checkpoint").read_bytes()
    with monkeypatch.context() as patch:
        refuse_writes(patch, name, after=after, code=code)
        status, out, err = call("run", "--resume", copy)

    assert (status, out) == (2, "")
    sentence = err[err.rindex("lqd: ") :]
    assert re.fullmatch(
        rf"lqd: Expected to write [^\n]+failed \({os.strerror(code)}\); [^\n]+\.\n", sentence
    )
    assert "Traceback" not in err
    assert (copy / "checkpoint").read_bytes() == checkpoint
    assert not list(copy.rglob(".*"))
    assert go_on_for_a_generation(copy, call, monkeypatch) == 4


def go_on_for_a_generation(folder, call, monkeypatch):
    def stop(_, metrics):
        if metrics.generation > 3:
            raise KeyboardInterrupt

    monkeypatch.setattr("lqd_search.cli.progress.RunProgress.show", stop)
    status, _, _ = call("run", "--resume", folder)
    assert status == 130
    return len(RunFolder(folder).state.load().metrics)


def test_other_versions_are_noted(copy, call, monkeypatch):
    began = installed_versions()
    here = began | {"numpy": "1.2.3"}
    monkeypatch.setattr("lqd_search.runs.run_config.installed_versions", lambda: here)
    monkeypatch.setattr("lqd_search.cli.progress.RunProgress.show", interrupt)
    status, _, err = call("run", "--resume", copy)

    assert (
        f"note: the run began with other versions, numpy {began['numpy']} (here 1.2.3); it may end "
        "otherwise than it would have with them\n"
    ) in err
    # It goes on, as far as to its progress.
    assert status == 130


def test_a_run_that_is_finished_by_another_process_is_not_begun_again(copy, run, call, monkeypatch):
    # Another process ends the run between the look at the folder and the lock.
    locked = RunFolder.locked

    def finish_and_lock(folder):
        for name in ("archive.npz", "outcomes.npz", "metrics.csv", "summary.json"):
            shutil.copy(run[0] / name, copy / name)
        folder.state.remove()
        return locked(folder)

    monkeypatch.setattr(RunFolder, "locked", finish_and_lock)
    status, out, err = call("run", "--resume", copy)

    assert (status, out) == (2, "")
    assert err.endswith(
        f"lqd: Expected an unfinished run in {copy}, but it is finished by now; see its figures "
        f"with `lqd show {copy}`.\n"
    )
    assert results(copy) == results(run[0])
    assert (copy / "metrics.csv").read_bytes() == (run[0] / "metrics.csv").read_bytes()


def test_who_allowed_a_weak_sandbox_is_told_to_do_so_again(copy, call, monkeypatch):
    monkeypatch.setattr("lqd_search.cli.progress.RunProgress.show", interrupt)
    status, _, err = call("run", "--resume", copy, "--allow-weak-sandbox")

    assert status == 130
    assert err.endswith(f"go on with `lqd run --resume {copy} --allow-weak-sandbox`\n")


def interrupt(*_):
    raise KeyboardInterrupt
