"""The `lqd` command as a shell sees it."""

import re
import subprocess
import sys

import pytest

from lqd_search.cli.commands import COMMANDS
from lqd_search.cli.main import lqd


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("run", "LQD/Nothing-v0"), r"known tasks are .*LQD/Faucet-v0"),
        (
            ("run", "LQD/Faucet-v0", "--sample", "77"),
            r"Found no recording of the success prompt with the key [0-9a-f]{64}; the nearest",
        ),
        (("run", "LQD/Faucet-v0", "--evaluations", "100", "--batch-size", "32"), "at most 5"),
        (("run", "LQD/Faucet-v0", "--evaluations", "none"), "not a valid integer"),
        (("show", "nowhere"), r"Expected a run in nowhere, but it is not there"),
        (("replay", "nowhere"), r"Expected a run in nowhere, but it is not there"),
    ],
)
def test_bad_input_is_one_sentence_and_status_2(arguments, message, call, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    status, out, err = call(*arguments)

    assert status == 2
    assert out == ""
    assert not list(tmp_path.iterdir())
    assert re.search(message, err)
    assert "Traceback" not in err


def test_help_names_the_commands_and_what_each_does(call):
    status, out, _ = call("--help")

    assert status == 0
    for command, summary in COMMANDS.items():
        assert re.search(rf"{command} +{re.escape(summary)}", out)


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_has_its_own_help(call, command):
    status, out, _ = call(command, "--help")

    assert status == 0
    assert out.startswith(f"Usage: lqd {command} [OPTIONS]")


def test_an_unknown_command_is_bad_input(call):
    status, out, err = call("runs")

    assert (status, out) == (2, "")
    assert "No such command 'runs'" in err


def test_the_help_does_without_what_a_search_imports():
    code = "import sys, lqd_search.cli.main as m; m.lqd.get_help(m.click.Context(m.lqd)); "
    code += "sys.exit('ribs' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_a_run_folder_of_another_layout_is_refused(call, tmp_path):
    (tmp_path / "config.json").write_text('{"format": 1, "task": "LQD/Faucet-v0"}')

    for command in (("show", tmp_path), ("replay", tmp_path), ("run", "--resume", tmp_path)):
        status, out, err = call(*command)

        assert (status, out) == (2, "")
        assert re.fullmatch(r"lqd: Expected the layout 4 in \S+, got 1; run the [^\n]+\n", err)


def test_the_help_names_the_exit_statuses(call):
    _, out, _ = call("--help")

    assert "exit status is 0; 1 if nothing is found or something differs" in " ".join(out.split())


@pytest.mark.parametrize("command", ["run", "infer", "adapt", "doctor"])
def test_no_number_of_threads_is_one_for_each_cpu(command):
    (threads,) = [p for p in lqd.get_command(None, command).params if p.name == "threads"]

    assert (threads.type.min, threads.default) == (0, 0)
