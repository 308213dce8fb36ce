"""`lqd doctor`: what it says of this machine, and of files of functions."""

import builtins
import json
import os
import sys
from importlib.metadata import PackageNotFoundError, version

import pytest

from lqd_llm.sandbox import Layer, SandboxError, corpus, supervisor
from lqd_llm.sandbox.wire import Lock
from lqd_search.cli import machine

LAYERS = ("process", "columns", "capabilities", "rlimits", "landlock", "seccomp")
HARMLESS = {
    "name": "harmless",
    "kind": "fitness",
    "entry": "fitness",
    "code": "def fitness(info):\n    return -info['gripper_position'][2]\n",
    "expected": "ok",
}
ATTACK = {
    "name": "attack",
    "kind": "success",
    "entry": "success",
    "code": "def success(infos):\n    return open('sandbox_canary', 'w')\n",
    "expected": "timeout",
    "also_ok": ["rejected"],
}


@pytest.fixture
def corpus_file(tmp_path):
    def write(*lines, name="corpus.jsonl"):
        file = tmp_path / name
        file.write_text("".join(json.dumps(line) + "\n" for line in lines))
        return file

    return write


@pytest.fixture
def holds(monkeypatch):
    """Say of every layer that it holds, without trying; of those named, that it does not."""

    def set_layers(*missing):
        layers = tuple(
            Layer(
                name, f"what {name} is for", name not in missing, f"no {name}" * (name in missing)
            )
            for name in LAYERS
        )
        monkeypatch.setattr("lqd_llm.sandbox.probe_layers", lambda: layers)

    return set_layers


def missing_module(monkeypatch, name):
    known = builtins.__import__

    def fail(module, *arguments, **options):
        if module.startswith("lqd_llm"):
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)
        return known(module, *arguments, **options)

    monkeypatch.setattr(builtins, "__import__", fail)


@pytest.mark.skipif(sys.platform != "linux", reason="the layers are Linux's")
def test_it_says_what_there_is(call):
    status, out, err = call("doctor")

    assert (status, err) == (0, "")
    for name in ("numpy", "mujoco", "ribs", "anthropic", "pydantic"):
        assert version(name) in out
    assert os.uname().machine in out
    assert os.uname().release in out
    for name in LAYERS:
        assert f"  {name} " in out
    assert out.count(" holds ") == len(LAYERS)
    assert out.endswith("run here.\n")


def test_a_missing_layer_is_no_failure(call, holds):
    holds("landlock", "seccomp")

    status, out, _ = call("doctor")

    assert status == 0
    assert out.count("MISSING") == 2
    assert "no landlock\n" in out
    assert "Without landlock, seccomp: recorded functions run as ever" in out.splitlines()[-1]
    assert out.splitlines()[-1].endswith("run only with --allow-weak-sandbox.")


@pytest.mark.parametrize(
    ("name", "said"),
    [("ANTHROPIC_API_KEY", "set (ANTHROPIC_API_KEY)"), ("OTHER", "not set (ANTHROPIC_API_KEY)")],
)
def test_a_key_is_said_to_be_there_and_never_shown(name, said, call, holds, monkeypatch):
    holds()
    for known in ("ANTHROPIC_API_KEY", "ANTHROPIC_AUTH_TOKEN"):
        monkeypatch.delenv(known, raising=False)
    monkeypatch.setenv(name, "sk-ant-very-secret")

    status, out, err = call("doctor")

    assert status == 0
    assert said in out
    assert "secret" not in out + err


def test_a_sandbox_that_does_not_work_is_a_failure(call, holds, monkeypatch):
    holds()
    monkeypatch.setattr(sys, "executable", "")

    status, out, _ = call("doctor")

    assert status == 1
    assert out.splitlines()[-1].startswith("The sandbox does not work here: Expected Python to")


def test_a_package_that_is_missing_is_a_failure(call, holds, monkeypatch):
    holds()

    def versions():
        raise PackageNotFoundError("mujoco")

    monkeypatch.setattr(machine, "installed_versions", versions)

    status, out, _ = call("doctor")

    assert status == 1
    assert "mujoco is not installed; run `pip install '.[all]'` in a clone of lqd-envs" in out
    assert "  seccomp " in out


def test_without_the_extra_there_is_no_sandbox(call, monkeypatch):
    missing_module(monkeypatch, "pydantic")

    status, out, _ = call("doctor")

    assert status == 0
    assert "Without the extra `llm` there is no sandbox (pydantic is missing)" in out


@pytest.mark.parametrize(
    ("gl", "display", "said"),
    [("egl", True, "egl (MUJOCO_GL)"), ("", True, "on the display"), ("", False, "none: ")],
)
def test_rendering(gl, display, said, monkeypatch):
    monkeypatch.setenv("MUJOCO_GL", gl)
    monkeypatch.setattr(machine, "has_display", lambda: display)

    assert dict(machine.machine_facts())["rendering"].startswith(said)


@pytest.mark.parametrize(("usable", "said"), [({0}, "1 of 4"), ({0, 1, 2, 3}, "4")])
def test_cpus(usable, said, monkeypatch):
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.setattr(os, "cpu_count", lambda: 4)
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: usable, raising=False)

    assert dict(machine.machine_facts())["CPUs"] == said


def test_an_extra_that_is_not_there_is_named(monkeypatch):
    def no_anthropic(name):
        if name == "anthropic":
            raise PackageNotFoundError(name)
        return "1.0"

    monkeypatch.setattr(machine, "version", no_anthropic)

    said = dict(machine.machine_facts())["extra llm"]
    assert said == "not installed (anthropic); run `pip install '.[all]'` in a clone of lqd-envs"


def test_files_whose_functions_all_end_as_expected(call, corpus_file):
    first = corpus_file(HARMLESS, ATTACK)
    second = corpus_file(ATTACK, name="second.jsonl")

    status, out, err = call("doctor", "--corpus", first, "--corpus", second, "--threads", 1)

    assert (status, err) == (0, "")
    assert f"{first}: 2 functions on 16 example motions of LQD/Grasp-v0" in out
    assert f"{second}: 1 function on 16 example motions" in out
    lines = [line.split() for line in out.splitlines()]
    assert ["harmless", "ok", "expected", "ok"] in lines
    assert lines.count(["attack", "rejected", "expected", "timeout", "(or", "rejected)"]) == 2
    assert out.endswith("\n3 functions: all as expected.\n")


def test_a_function_that_ends_otherwise_is_marked(call, corpus_file):
    other = HARMLESS | {"name": "attack\x1b[2J\ud800", "expected": "rejected"}
    wrong = HARMLESS | {"name": "wrong", "code": "def fitness(info):\n    return info['mug']\n"}

    status, out, _ = call("doctor", "--corpus", corpus_file(HARMLESS, other, wrong))

    assert status == 1
    marked = [line for line in out.splitlines() if line.startswith("! ")]
    assert [line.split()[0:5] + line.split()[-1:] for line in marked] == [
        ["!", "attack\ufffd[2J\ufffd", "ok", "expected", "rejected", "DIFFERS"],
        ["!", "wrong", "bad_value", "expected", "ok", "DIFFERS"],
    ]
    assert "    it raised KeyError in line 2\n" in out
    assert out.endswith("\n3 functions, 2 not as expected: attack\ufffd[2J\ufffd, wrong.\n")


def test_another_task(call, corpus_file):
    taps = HARMLESS | {
        "code": "def fitness(info):\n    return info['joint_positions']['hot_tap']\n"
    }

    status, out, _ = call("doctor", "--corpus", corpus_file(taps), "--task", "LQD/Faucet-v0")

    assert status == 0
    assert "example motions of LQD/Faucet-v0" in out


def test_without_a_layer_functions_run_only_if_that_is_allowed(call, corpus_file, monkeypatch):
    monkeypatch.setattr(supervisor, "Lock", _WithoutLandlock())
    file = corpus_file(HARMLESS)

    status, _, err = call("doctor", "--corpus", file)
    allowed, out, _ = call("doctor", "--corpus", file, "--allow-weak-sandbox")

    assert status == 2
    assert "Expected all layers of the sandbox, but this system lacks landlock" in err
    assert "--allow-weak-sandbox" in err
    assert allowed == 0
    assert "1 function: all as expected." in out


class _WithoutLandlock:
    """Stands in for `Lock` where the host reads which locks a worker has put on."""

    def __call__(self, bits):
        return Lock(bits) & ~Lock.LANDLOCK

    def __iter__(self):
        return iter(Lock)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (None, "The corpus .* cannot be read"),
        ("{", "Expected an object with name, kind, entry, code and expected, but .*:1 is another"),
        (json.dumps(HARMLESS | {"kind": "other"}), "'other' is not a valid Role"),
    ],
)
def test_a_file_that_cannot_be_read_is_one_sentence(text, words, call, corpus_file, tmp_path):
    good, bad = corpus_file(HARMLESS), tmp_path / "bad.jsonl"
    if text is not None:
        bad.write_text(text)

    status, out, err = call("doctor", "--corpus", good, "--corpus", bad)

    assert (status, out) == (2, "")
    assert err.startswith("lqd: ")
    assert err.count("\n") == 1
    with pytest.raises(SandboxError, match=words):
        corpus.read_corpus(bad)


def test_a_task_that_there_is_not(call, corpus_file):
    status, _, err = call("doctor", "--corpus", corpus_file(HARMLESS), "--task", "LQD/Nothing-v0")

    assert status == 2
    assert "known tasks are" in err


def test_a_corpus_needs_the_extra(call, corpus_file, monkeypatch):
    file = corpus_file(HARMLESS)
    missing_module(monkeypatch, "pydantic")

    status, _, err = call("doctor", "--corpus", file)

    assert status == 2
    assert "Expected the packages of the extra `llm` to try functions, but pydantic is not" in err
