import ast
import re
import subprocess
import sys

import pytest

from lqd_llm import KINDS, load_recording, render_prompt, render_system
from lqd_llm.answer import Answer, read_reply
from lqd_llm.errors import LQDError, MissingRecordingError
from lqd_llm.exchange_folder import ExchangeFolder
from lqd_llm.model_options import ModelOptions
from lqd_llm.replay_provider import ReplayProvider
from lqd_llm.request import Turn

pytestmark = pytest.mark.usefixtures("no_network")


@pytest.fixture(scope="module")
def replay():
    return ReplayProvider()


@pytest.fixture
def ask_for(ask):
    def request(task, kind, **changes):
        prompt = render_prompt(kind, instruction=changes.pop("instruction", task.instruction))
        return ask(prompt, subject=kind, system=render_system(task.schema), **changes)

    return request


def test_recordings_that_ship_answer_whatever_the_model(replay, task, sample, ask_for):
    recording = load_recording(task.name, sample=sample)
    options = ModelOptions(model="claude-haiku-5-5", effort="max", max_tokens=1)
    for kind in KINDS:
        request = ask_for(task, kind, sample=sample, options=options)
        answer = replay.ask(request)

        assert read_reply(answer, request=request) == recording.exchanges[kind].reply
        assert answer.model == recording.model
        assert answer.provenance == recording.provenance
        assert answer.usage.unreported == 1


def miss(provider, request):
    with pytest.raises(MissingRecordingError) as caught:
        provider.ask(request)
    assert isinstance(caught.value, LQDError)
    return str(caught.value)


def test_miss_names_the_key_and_what_differs(replay, faucet, ask_for):
    request = ask_for(faucet, "fitness", sample=7, instruction="Turn on the cold water")

    assert miss(replay, request) == (
        f"Found no recording of the fitness prompt with the key {request.key}; the nearest is "
        "faucet-0.json, but the sample is 0 there and 7 here, and line 1 of the messages is "
        "'user: The task is: \"Turn on the hot water\"' there and "
        "'user: The task is: \"Turn on the cold water\"' here; "
        "ask for what is recorded (the instructions of the tasks drawer, faucet, grasp, push, with "
        "the samples 0, 1, 2, 3, 4), ask a model with `--llm live` or `--llm record`, or write "
        "functionals of your own for `lqd run --functionals`."
    )


def test_nearest_is_of_the_same_kind_and_sample(replay, task, ask_for):
    for kind in KINDS:
        told = miss(replay, ask_for(task, kind, sample=3, instruction="Wave"))

        # The two tasks of the mug share everything but the instruction.
        name = "(grasp|push)" if task.name in ("grasp", "push") else task.name
        assert re.search(rf"nearest is {name}-3\.json, but line 1 of the messages is", told)


def test_repair_is_not_recorded(replay, faucet, ask_for):
    told = miss(replay, ask_for(faucet, "fitness", attempt=1))

    assert "the nearest is faucet-0.json, but the repair attempt is 0 there and 1 here" in told


def test_own_recording_comes_first_and_answers_only_its_key(tmp_path, faucet, ask_for, words):
    request = ask_for(faucet, "fitness")
    mine = Answer(words.message('{"functions": []}'), provenance="Mine.")
    ExchangeFolder(tmp_path).write(request, mine)
    provider = ReplayProvider(tmp_path)

    assert provider.ask(request) == mine
    other_model = ask_for(faucet, "fitness", options=ModelOptions(model="claude-haiku-5-5"))
    assert provider.ask(other_model).provenance != "Mine."


@pytest.mark.parametrize(
    ("changes", "difference"),
    [
        (
            {"options": ModelOptions(model="claude-haiku-5-5")},
            "the model is 'claude-opus-5-5' there and 'claude-haiku-5-5' here",
        ),
        ({"sample": 4}, "the sample is 0 there and 4 here"),
        ({"attempt": 2}, "the repair attempt is 0 there and 2 here"),
        ({"schema": {}}, "line 1 of the schema is '{' there and '{}' here"),
        (
            {"system": "Be\nbrief."},
            "line 1 of the system prompt is 'Be brief.' there and 'Be' here",
        ),
        (
            {"messages": (Turn("user", "Mine\n"),)},
            "line 2 of the messages is missing there and '' here",
        ),
    ],
)
def test_miss_names_what_differs_from_an_own_recording(tmp_path, ask, words, changes, difference):
    request = ask("Mine")
    ExchangeFolder(tmp_path).write(request, Answer(words.message("{}"), provenance="Mine."))

    told = miss(ReplayProvider(tmp_path), ask(**{"prompt": "Mine", **changes}))

    assert f"the nearest is {request.key}.json, but {difference}; ask for what" in told


def test_folder_that_is_not_there_holds_nothing(tmp_path, faucet, ask_for):
    provider = ReplayProvider(tmp_path / "none")

    assert provider.ask(ask_for(faucet, "success")).model == "claude (version not reported)"


def test_replaying_does_not_even_load_the_sdk():
    code = "import sys, lqd_llm.inference, lqd_llm.replay_provider\nprint(sorted(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)

    loaded = ast.literal_eval(done.stdout)
    assert "lqd_llm.replay_provider" in loaded
    assert not [name for name in loaded if name.startswith(("anthropic", "httpx"))]
