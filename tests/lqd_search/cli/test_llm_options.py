"""The options that say which model is asked."""

import subprocess
import sys
from pathlib import Path

import click
import pytest
from click.testing import CliRunner

from lqd_envs import LQDError
from lqd_llm import DEFAULT_MODEL, EFFORTS, KeepingProvider, LiveProvider, ReplayProvider
from lqd_llm.model_options import MOST_TOKENS, ModelOptions
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

    given = ("model", "effort", "max_tokens")
    llm = LLMOptions("record", Path("a"), model="m", effort="low", max_tokens=5, given=given)
    assert handed == {"task": "it", "instruction": "Wave", "sample": 3, "llm": llm}


def test_defaults_are_those_of_the_package():
    handed = parse()

    assert handed == {"task": "it", "instruction": None, "sample": 0, "llm": LLMOptions()}
    assert handed["llm"].model_options() == ModelOptions()
    assert handed["llm"].model == DEFAULT_MODEL
    assert (module.EFFORTS, module.MOST_TOKENS) == (EFFORTS, MOST_TOKENS)


@pytest.mark.usefixtures("no_credentials")
def test_what_answers(tmp_path, monkeypatch):
    monkeypatch.setenv("ANTHROPIC_API_KEY", "sk-ant-test")
    kinds = {"replay": ReplayProvider, "record": KeepingProvider, "live": LiveProvider}
    for mode, kind in kinds.items():
        with LLMOptions(mode).provider() as provider:
            assert type(provider) is kind
        assert LLMOptions(mode).asks_a_model == (mode != "replay")
        with LLMOptions(mode).provider(transcript=tmp_path) as provider:
            assert type(provider) is KeepingProvider
    with LLMOptions("replay", tmp_path).provider() as provider:
        assert type(provider) is ReplayProvider


def test_more_tokens_than_can_come_are_refused():
    command = click.command()(llm_options(lambda **_: None))
    result = CliRunner().invoke(command, ["--max-tokens", str(MOST_TOKENS + 1)])

    assert result.exit_code == 2
    assert "21334 is not in the range 1<=x<=21333" in result.output


def test_credentials_that_cannot_be_loaded(monkeypatch):
    monkeypatch.setenv("ANTHROPIC_PROFILE", "no-such-profile")

    with pytest.raises(LQDError, match="cannot be loaded"), LLMOptions("live").provider():
        pytest.fail("there are no credentials")


def test_the_command_line_does_not_import_what_needs_the_extra():
    code = "import sys, lqd_search.cli.main; sys.exit('lqd_llm' in sys.modules)"

    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def check(*arguments):
    with parse(*arguments)["llm"].provider():
        pass


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (("--model", DEFAULT_MODEL), "--model"),
        (("--effort", "low", "--max-tokens", "20000"), "--effort, --max-tokens"),
        (("--recordings", ".", "--effort", "low", "--max-tokens", "9"), "--max-tokens"),
    ],
)
def test_what_would_not_be_heeded_is_refused(arguments, named):
    with pytest.raises(
        LQDError, match=f"^Expected {named} with --llm record or --llm live only, .*; leave it out"
    ):
        check(*arguments)


@pytest.mark.usefixtures("no_credentials")
def test_what_is_heeded_is_not_refused(monkeypatch):
    monkeypatch.setenv("ANTHROPIC_API_KEY", "sk-ant-test")

    check()
    check("--llm", "live", "--model", "m", "--effort", "low", "--max-tokens", "9")
    # By these the recordings of one's own are found.
    check("--recordings", ".", "--model", "m", "--effort", "low")


def test_the_help_says_which_answer_has_which_name():
    (llm,) = [p for p in click.command()(llm_options(print)).params if p.name == "llm"]

    for mode in ("replay, recordings", "record, a model", "live, such a model"):
        assert mode in llm.help
