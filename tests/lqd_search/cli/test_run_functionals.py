"""Where the functionals of `lqd run` come from, and where they run."""

import contextlib
import json
import os
import shutil
import signal
import threading
from pathlib import Path

import numpy as np
import pytest

from lqd_envs import get_task
from lqd_llm import ExchangeFolder
from lqd_llm.sandbox import Sandbox
from lqd_search.runs.functionals_folder import read_functionals
from lqd_search.runs.run_folder import RunFolder

TASK = "LQD/Faucet-v0"
# As the run of the fixture `run`.
SIZE = ("--evaluations", 320, "--batch-size", 16, "--seed", 1, "--threads", 1)
SMALL = ("--evaluations", 40, "--batch-size", 2, "--threads", 1)


@pytest.fixture
def functionals(run, tmp_path):
    """A copy of the functionals of a finished run."""
    return Path(shutil.copytree(run[0] / "functionals", tmp_path / "functionals"))


def write(folder, name, code):
    (folder / name).write_text(f"# Written by a test.\n{code}\n")


def test_everything_that_was_inferred_is_kept(run):
    folder = RunFolder.open(run[0])
    config, texts = folder.config(), folder.functionals()

    assert [sum(text.kind == kind for text in texts) for kind in ("fitness", "quantity")] == [3, 4]
    assert sum(text.kind.startswith("direct.") for text in texts) == 3
    assert (config.llm, config.explored) == ("replay", 3)
    assert config.lengths.keys() == {"direct.descriptor"} | {
        text.name for text in texts if text.kind == "quantity"
    }
    assert config.usage["requests"] == 5
    exchanges = list(ExchangeFolder(run[0] / "inference").exchanges())
    assert {exchange.request.subject for exchange in exchanges} == config.prompt_hashes.keys()
    assert not list(run[0].parent.glob(".*"))


def test_the_functionals_of_a_run_give_the_same_run_again_on_other_threads(
    run, call, tmp_path, functionals
):
    again = tmp_path / "again"
    status, out, _ = call(
        "run", TASK, *SIZE, "--threads", 2, "--functionals", functionals, "--out", again
    )

    assert status == 0
    assert "Functionals: model claude" in out
    for name in ("archive.npz", "outcomes.npz"):
        assert (again / name).read_bytes() == (run[0] / name).read_bytes()
    config, earlier = RunFolder(again).config(), RunFolder(run[0]).config()
    assert config.llm == "folder"
    assert config.functionals == earlier.functionals
    assert config.prompt_hashes == earlier.prompt_hashes
    assert earlier.provenance in config.provenance
    assert not (again / "inference").exists()


def test_a_person_may_edit_them(call, tmp_path, functionals):
    for file in functionals.glob("fitness.*.py"):
        file.unlink()
    write(functionals, "fitness.low.py", "def fitness(info): return -info['gripper_position'][2]")
    write(functionals, "fitness.high.py", "def fitness(info): return info['gripper_position'][2]")

    status, out, err = call("run", TASK, *SMALL, "--functionals", functionals,
                            "--out", tmp_path / "run")  # fmt: skip

    assert status == 0, err
    assert RunFolder(tmp_path / "run").summary()["exploration"].keys() == {"low", "high"}
    assert RunFolder(tmp_path / "run").config().explored == 2
    assert "exploring high" in out


def test_one_that_fails_its_check_is_named_with_its_line(call, tmp_path, functionals):
    write(functionals, "fitness.mine.py", "def fitness(info):\n    return info['nothing']")

    status, out, err = call("run", TASK, *SMALL, "--functionals", functionals,
                            "--out", tmp_path / "run")  # fmt: skip

    assert (status, out) == (2, "")
    assert "fitness.mine.py fails (KeyError in line 3" in err
    assert len(err.strip().splitlines()) == 1
    assert not (tmp_path / "run").exists()


@pytest.mark.slow
def test_a_run_goes_on_without_values_that_no_example_warned_of(call, tmp_path, functionals):
    # The examples do not see it: at each moment there is a chance of one in two hundred.
    rare = "info['gripper_position'][0] * 1e9 % 1.0 < 0.005"
    for file in functionals.glob("quantity.*.py"):
        file.unlink()
    write(functionals, "quantity.none.py",
          f"def quantity(info): return None if {rare} else info['gripper_position']")  # fmt: skip
    write(functionals, "quantity.nan.py",
          f"def quantity(info): return (1.0, math.nan if {rare} else 0.0)")  # fmt: skip
    write(functionals, "quantity.longer.py",
          f"def quantity(info): return (1.0,) * (2 + ({rare}))")  # fmt: skip

    # Long enough that some are met: a descriptor is asked at four moments of a motion.
    size = ("--evaluations", 1280, "--batch-size", 64, "--threads", 1)
    status, _, err = call(
        "run", TASK, *size, "--functionals", functionals, "--out", tmp_path / "run"
    )

    summary = RunFolder(tmp_path / "run").summary()
    assert status == 0, err
    refused = {row["functional"]: row for row in summary["refused"]}
    assert refused.keys() == {"none", "nan", "longer"}
    for name in refused:
        assert refused[name]["count"] > 0
        assert f"the quantity function '{name}' returned" in " ".join(err.split())


@pytest.mark.slow
def test_one_that_is_stopped_is_said_and_not_called_any_more(call, tmp_path, functionals):
    write(functionals, "fitness.endless.py",
          "def fitness(info):\n"
          "    while 0.5 < info['gripper_position'][0] * 3e9 % 1.0 < 0.5002: pass\n"
          "    return 0.0")  # fmt: skip

    status, out, err = call(
        "run", TASK, *SIZE, "--functionals", functionals, "--out", tmp_path / "run"
    )

    assert status == 0, err
    [sentence] = RunFolder(tmp_path / "run").summary()["stopped"]
    assert sentence.startswith("The fitness function 'endless' is not used any more: it ")
    assert sentence in " ".join(out.split())
    assert sentence in " ".join(err.split())


@pytest.mark.slow
def test_killing_the_sandbox_at_random_moments_changes_nothing(run, call, tmp_path, monkeypatch):
    rng, kills = np.random.default_rng(0), []
    judge = Sandbox.run

    def run_and_be_killed(sandbox, columns, **options):
        def kill():
            if (pid := sandbox.worker_pid) is not None:
                with contextlib.suppress(ProcessLookupError):
                    os.kill(pid, signal.SIGKILL)
                    kills.append(pid)

        timer = threading.Timer(rng.uniform(0.0, 0.01), kill)
        if rng.random() < 0.5:
            timer.start()
        results = judge(sandbox, columns, **options)
        if timer.ident is not None:
            timer.join()
        return results

    monkeypatch.setattr(Sandbox, "run", run_and_be_killed)
    status, _, err = call("run", TASK, *SIZE, "--out", tmp_path / "run")

    assert status == 0, err
    assert len(set(kills)) >= 5
    for name in ("archive.npz", "outcomes.npz"):
        assert (tmp_path / "run" / name).read_bytes() == (run[0] / name).read_bytes()
    assert RunFolder(tmp_path / "run").summary()["stopped"] == []


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            ("--sample", 1, "--model", "claude"),
            "no option that says how to infer functionals beside --functionals, but got --sample, "
            "--model; leave out the one or the other",
        ),
        (
            ("--method", "handcrafted"),
            "with the method 'handcrafted', which the expert steers, but got one of them",
        ),
    ],
)
def test_what_does_not_go_together_is_refused(call, tmp_path, functionals, arguments, message):
    status, out, err = call("run", TASK, *SMALL, "--functionals", functionals, *arguments,
                            "--out", tmp_path / "run")  # fmt: skip

    assert (status, out) == (2, "")
    assert message in err
    assert not (tmp_path / "run").exists()


def test_a_method_without_its_functionals_is_refused(call, tmp_path, functionals):
    (functionals / "direct.fitness.py").unlink()

    status, _, err = call("run", TASK, *SMALL, "--method", "direct", "--functionals", functionals,
                          "--out", tmp_path / "run")  # fmt: skip

    assert status == 2
    assert "can steer the method 'direct', but there is no direct.fitness; add" in err


def test_bad_workers_make_no_folder(call, tmp_path):
    status, _, err = call("run", TASK, *SMALL, "--workers", "somewhere", "--out", tmp_path / "run")

    assert status == 2
    assert "'tcp://host:port'" in err
    assert not (tmp_path / "run").exists()


@pytest.mark.usefixtures("no_credentials", "sleeps")
def test_a_run_that_asks_a_model(call, api, tmp_path, monkeypatch):
    monkeypatch.setenv("ANTHROPIC_API_KEY", "sk-ant-test-0123456789")
    monkeypatch.setenv("ANTHROPIC_BASE_URL", api.url)
    arguments = ("run", TASK, *SMALL, "--llm", "live", "--out", tmp_path / "run")
    answer = api.answer

    # The third request fails for good: what was answered before is kept, and used at the next try.
    api.answer = lambda body: api.response(status=400) if len(api.bodies) == 3 else answer(body)
    status, _, err = call(*arguments)
    assert status == 2
    assert "kept in" in err
    assert not (tmp_path / "run").exists()

    api.answer = answer
    status, out, err = call(*arguments)

    assert status == 0, err
    assert len(api.bodies) == 6
    folder = RunFolder(tmp_path / "run")
    config = folder.config()
    assert (config.llm, config.model) == ("live", "claude-opus-5-5")
    assert (config.usage["requests"], config.usage["output_tokens"]) == (5, 100)
    assert config.usage["cost"] > 0.0
    assert "Usage: 5 requests" in " ".join(out.split())
    assert len(list(ExchangeFolder(folder.path / "inference").exchanges())) == 5
    assert not list(tmp_path.glob(".inference-*"))
    before = len(api.bodies)
    assert call("run", "--resume", folder.path)[0] == 0
    assert len(api.bodies) == before


SAMPLES = [
    pytest.param(task, sample, marks=() if sample == 3 and "Drawer" in task else pytest.mark.slow)
    for task in ("LQD/Faucet-v0", "LQD/Drawer-v0", "LQD/Push-v0", "LQD/Grasp-v0")
    for sample in range(5)
]


@pytest.mark.parametrize(("task", "sample"), SAMPLES)
def test_a_run_uses_the_sandbox_with_every_recorded_sample(
    call, tmp_path, monkeypatch, task, sample
):
    motions = []
    run = Sandbox.run

    def noting(sandbox, columns, **options):
        motions.append(len(next(iter(columns.values()))))
        return run(sandbox, columns, **options)

    monkeypatch.setattr(Sandbox, "run", noting)
    status, _, err = call("run", task, *SMALL, "--sample", sample, "--out", tmp_path / "run")

    assert status == 0, err
    folder = RunFolder(tmp_path / "run")
    summary = folder.summary()
    # Twice for the checks, then for the run.
    assert sum(motions[2:]) == summary["valid"] > 0
    assert summary["dropped"] == summary["stopped"] == []
    assert folder.config().instruction == get_task(task).instruction
    texts = read_functionals(folder.path / "functionals")
    assert len(texts) == 15
    assert json.loads((folder.path / "config.json").read_text())["llm"] == "replay"
