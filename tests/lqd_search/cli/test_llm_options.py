"""The options that say which model is asked."""

import subprocess
import sys
from pathlib import Path

import click
import pytest
from click.testing import CliRunner

from lqd_envs import LQDError
from lqd_llm import DEFAULT_MODEL, EFFORTS, KeepingProvider, LiveProvider, ReplayProvider
from lqd_llm.model_options import ModelOptions
from lqd_search.cli import llm_options as module
from lqd_search.cli.llm_options import LLMOptions, llm_options


def parse(*arguments):
    """The options as a command is handed them."""
    handed = {}

    @click.command()
    @click.argument("task")
    @llm_options
    @click.pass_context
    def command(context, **options):
        assert context.command is command
        handed.update(options)

    result = CliRunner().invoke(command, ["it", *arguments], catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return handed


def test_what_a_command_is_handed():
    arguments = ("--llm", "record", "--recordings", "a", "--model", "m", "--effort", "low")
    handed = parse(*arguments, "--max-tokens", "5", "--instruction", "Wave", "--sample", "3")

    llm = LLMOptions("record", Path("a"), model="m", effort="low", max_tokens=5)
    assert handed == {"task": "it", "instruction": "Wave", "sample": 3, "llm": llm}


def test_defaults_are_those_of_the_package():
    handed = parse()

    assert handed == {"task": "it", "instruction": None, "sample": 0, "llm": LLMOptions()}
    assert handed["llm"].model_options() == ModelOptions()
    assert handed["llm"].model == DEFAULT_MODEL
    assert module.EFFORTS == EFFORTS


@pytest.mark.usefixtures("no_credentials")
def test_what_answers(tmp_path, monkeypatch):
    monkeypatch.setenv("ANTHROPIC_API_KEY", "sk-ant-test")
    kinds = {"replay": ReplayProvider, "record": KeepingProvider, "live": LiveProvider}
    for mode, kind in kinds.items():
        with LLMOptions(mode).provider() as provider:
            assert type(provider) is kind
        assert LLMOptions(mode).asks_a_model == (mode != "replay")
    with LLMOptions("replay", tmp_path).provider() as provider:
        assert type(provider) is ReplayProvider


def test_credentials_that_cannot_be_loaded(monkeypatch):
    monkeypatch.setenv("ANTHROPIC_PROFILE", "no-such-profile")

    with pytest.raises(LQDError, match="cannot be loaded"), LLMOptions("live").provider():
        pytest.fail("there are no credentials")


def test_the_command_line_does_not_import_what_needs_the_extra():
    code = "import sys, lqd_search.cli.main; sys.exit('lqd_llm' in sys.modules)"

    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
