"""The `lqd` command as a shell sees it."""

import re

import pytest


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
def test_bad_input_is_one_sentence_and_status_2(arguments, message, call, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    status, out, err = call(*arguments)

    assert status == 2
    assert out == ""
    assert not list(tmp_path.iterdir())
    assert re.search(message, err)
    assert "Traceback" not in err


def test_help_names_the_commands(call):
    status, out, _ = call("--help")

    assert status == 0
    for command in ("run", "show", "replay"):
        assert command in out


def test_a_run_folder_of_another_layout_is_refused(call, tmp_path):
    (tmp_path / "config.json").write_text('{"format": 1, "task": "LQD/Faucet-v0"}')

    for command in (("show", tmp_path), ("replay", tmp_path), ("run", "--resume", tmp_path)):
        status, out, err = call(*command)

        assert (status, out) == (2, "")
        assert re.fullmatch(r"lqd: Expected the layout 2 in \S+, got 1; read it with [^\n]+\n", err)
