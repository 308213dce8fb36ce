import os
import subprocess
import sys
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from anthropic import Anthropic

from lqd_llm import (
    KINDS,
    CheckFailure,
    CheckOutcome,
    load_recording,
    prompt_hash,
    render_prompt,
    render_system,
)
from lqd_llm.errors import (
    InferenceError,
    MissingRecordingError,
    ProviderError,
    ReplyError,
)
from lqd_llm.exchange_folder import ExchangeFolder
from lqd_llm.functions import ENTRIES
from lqd_llm.inference import infer
from lqd_llm.keeping_provider import KeepingProvider
from lqd_llm.live_provider import LiveProvider
from lqd_llm.model_options import ModelOptions
from lqd_llm.replay_provider import ReplayProvider
from lqd_llm.usage import Usage

KEY = "sk-ant-test-0123456789"


def one_by_one(find):
    """A check that finds what is wrong with each function alone."""
    return lambda candidates: [CheckOutcome(find(candidate)) for candidate in candidates]


passes = one_by_one(lambda _: None)


def fails(*names):
    """A check that some functions fail as long as their code is not repaired."""

    def find(candidate):
        if candidate.source.name in names and "repaired" not in candidate.source.code:
            return CheckFailure("KeyError", "no such key", line=2)
        return None

    return one_by_one(find)


def run(task, provider, *, check=passes, **options):
    return infer(
        instruction=task.instruction, schema=task.schema, provider=provider, check=check, **options
    )


def codes(functionals):
    direct = functionals.direct
    groups = {
        "success": (functionals.success,),
        "fitness": functionals.fitness,
        "timestamps": functionals.timestamps,
        "quantities": functionals.quantities,
        "direct": (direct.success, direct.fitness, direct.descriptor),
    }
    return {kind: [(f.name, f.entry, f.code) for f in group] for kind, group in groups.items()}


@pytest.fixture
def model(scripted, words):
    """A model that replies to the faucet's prompts as it was recorded, and cannot repair."""
    return scripted(lambda request: words.recorded_reply(request.messages[0].text))


@pytest.fixture
def live(api, no_credentials):  # noqa: ARG001
    with LiveProvider(Anthropic(api_key=KEY, base_url=api.url, max_retries=0)) as provider:
        yield provider


@pytest.mark.usefixtures("no_network")
def test_replay_gives_what_was_recorded(task, sample):
    functionals = run(task, ReplayProvider(), sample=sample)
    recorded = load_recording(task.name, sample=sample)

    assert codes(functionals) == {
        kind: [(f.name, ENTRIES.get(kind, f.name), f.code) for f in exchange.reply.functions]
        for kind, exchange in recorded.exchanges.items()
    }
    assert functionals.prompt_hashes == {
        kind: prompt_hash(recorded.system, exchange.prompt)
        for kind, exchange in recorded.exchanges.items()
    }
    assert functionals.model == recorded.model
    assert functionals.provenance == recorded.provenance
    assert functionals.usage == Usage(requests=5, unreported=5)
    assert (functionals.dropped, functionals.repaired) == ((), ())


def test_each_kind_is_asked_in_one_request(faucet, model):
    functionals = run(faucet, model, sample=3, options=ModelOptions(effort="low"))

    assert [request.subject for request in model.requests] == list(KINDS)
    system = render_system(faucet.schema)
    for request in model.requests:
        prompt = render_prompt(request.subject, instruction=faucet.instruction)
        assert [turn.text for turn in request.messages] == [prompt]
        assert (request.system, request.sample, request.attempt) == (system, 3, 0)
        assert request.options.effort == "low"
        assert functionals.prompt_hashes[request.subject] == prompt_hash(system, prompt)
    assert functionals.model == "claude-opus-5-5"
    assert functionals.provenance == "A script."
    assert functionals.usage.requests == 5
    assert functionals.usage.output_tokens == 100
    assert functionals.usage.total_cost == pytest.approx(5 * (100 * 4 + 20 * 20) / 1e6)


def test_what_a_model_wrote_is_not_run(faucet, scripted, words, tmp_path):
    canary = tmp_path / "canary"
    harm = f"open({str(canary)!r}, 'w')\ndef {{0}}(x): return open({str(canary)!r}, 'w')"

    def reply(request):
        entries = {"success": ["success"], "direct": ["success", "fitness", "descriptor"]}
        names = entries.get(request.subject, ["a"])
        return words.reply_text(*[(name, harm.format(name)) for name in names])

    functionals = run(faucet, scripted(reply))

    assert functionals.success.code == harm.format("success")
    assert not canary.exists()


def test_all_functions_are_checked_at_once_with_their_kinds_and_entries(faucet, model):
    calls = []

    def check(candidates):
        calls.append(candidates)
        assert len(model.requests) == 5
        return [CheckOutcome() for _ in candidates]

    run(faucet, model, check=check)

    (candidates,) = calls
    assert all(f"def {its.entry}(" in its.source.code for its in candidates)
    assert Counter((its.kind, its.entry) for its in candidates) == {
        ("success", "success"): 1,
        ("fitness", "fitness"): 3,
        ("timestamps", "timestamp"): 4,
        ("quantities", "quantity"): 4,
        ("direct", "success"): 1,
        ("direct", "fitness"): 1,
        ("direct", "descriptor"): 1,
    }


@pytest.fixture
def repairing(scripted, words):
    """A model that repairs on its second attempt."""

    def reply(request):
        if request.attempt == 0:
            return words.recorded_reply(request.messages[0].text)
        code = "def f(x): return 'repaired'" if request.attempt == 2 else "def f(x): return 0"
        return words.reply_text(("any", code))

    return scripted(reply)


def test_function_that_fails_is_repaired(faucet, repairing):
    recorded = run(faucet, ReplayProvider())
    first = recorded.fitness[0].name
    functionals = run(faucet, repairing, check=fails(first))

    assert [f.name for f in functionals.fitness] == [f.name for f in recorded.fitness]
    assert functionals.fitness[0].code == "def f(x): return 'repaired'"
    assert functionals.repaired == (
        f"The fitness function '{first}' passes its check after 2 repairs (before: KeyError in "
        "line 2: no such key).",
    )
    assert functionals.dropped == ()
    assert functionals.usage.requests == 7


def test_function_that_never_passes_is_dropped(faucet, scripted, words):
    recorded = run(faucet, ReplayProvider())
    first = recorded.timestamps[1].name

    def reply(request):
        if request.attempt == 0:
            return words.recorded_reply(request.messages[0].text)
        return words.reply_text((first, "def timestamp(infos): return 7"))

    model = scripted(reply)
    functionals = run(faucet, model, check=fails(first))

    assert len(functionals.timestamps) == 3
    assert len(model.requests) == 5 + 3
    assert functionals.dropped == (
        f"The timestamps function '{first}' is not used: it still fails its check after 3 repairs "
        "(KeyError in line 2: no such key).",
    )


def test_function_beyond_the_number_stands_in_for_one_that_fails(faucet, scripted, words):
    names = ("one", "two", "three", "spare", "late")

    def reply(request):
        if request.attempt:
            return words.reply_text()
        if request.subject == "fitness":
            return words.reply_text(*[(name, f"def fitness(info): {name}") for name in names])
        return words.recorded_reply(request.messages[0].text)

    calls = []
    find = fails("two")

    def check(candidates):
        calls.append([its.source.name for its in candidates if its.kind == "fitness"])
        return find(candidates)

    functionals = run(faucet, scripted(reply), check=check)

    assert [f.name for f in functionals.fitness] == ["one", "three", "spare"]
    assert calls == [["one", "two", "three"], ["spare"]]
    assert [sentence.split("'")[1] for sentence in functionals.dropped] == ["two", "late"]


def test_repairs_stay_few_however_long_a_reply_is(faucet, scripted, words):
    names = [f"f{k}" for k in range(60)]

    def reply(request):
        if request.attempt:
            return words.reply_text(("any", "def fitness(info): return 0"))
        if request.subject == "fitness":
            return words.reply_text(*[(name, f"def fitness(info): {name}") for name in names])
        return words.recorded_reply(request.messages[0].text)

    model = scripted(reply)
    with pytest.raises(InferenceError, match="got none out of f0, f1, f2, f3, f4 and 55 more"):
        run(faucet, model, check=fails(*names))
    assert len(model.requests) == 5 + 3 * 3

    functionals = run(faucet, model, check=fails(*names[:40]))
    assert [f.name for f in functionals.fitness] == ["f40", "f41", "f42"]
    assert functionals.dropped[2].startswith("The fitness function 'f2' is not used: it still fail")
    assert functionals.dropped[3] == (
        "The fitness function 'f3' is not used: it fails its check (KeyError in line 2: no such "
        "key), and only the first 3 are repaired."
    )


def test_lengths_and_remarks_are_those_of_the_functions_that_are_used(faucet, scripted, words):
    recorded = run(faucet, ReplayProvider())
    first, second = (f.name for f in recorded.quantities[:2])
    same = np.ones((6, 3, 5))

    def check(candidates):
        outcomes = []
        for its in candidates:
            bad = its.source.name == first and "repaired" not in its.source.code
            length = {"quantity": 3, "descriptor": 2}.get(its.entry)
            values = same if its.source.name in (first, second) else None
            failure = CheckFailure("KeyError", "no") if bad else None
            outcomes.append(CheckOutcome(failure, None if bad else length, values))
        return outcomes

    def reply(request):
        if request.attempt:
            return words.reply_text((first, "def quantity(info): return 'repaired'"))
        return words.recorded_reply(request.messages[0].text)

    functionals = run(faucet, scripted(reply), check=check)

    lengths = {f.name: 3 for f in recorded.quantities} | {"direct.descriptor": 2}
    assert functionals.lengths == lengths
    assert [sentence.split("'")[1] for sentence in functionals.remarks] == [first, second]
    dropped = run(faucet, ReplayProvider(), check=check)
    assert first not in dropped.lengths
    assert [sentence.split("'")[1] for sentence in dropped.remarks] == [second]


def test_code_that_never_passes_is_asked_for_three_times(faucet, api, live, words, tmp_path):
    first = run(faucet, ReplayProvider()).fitness[0].name
    answer = api.answer
    bad = api.response(words.message(words.reply_text((first, "def fitness(info): return 7"))))
    api.answer = lambda body: bad if "```python" in body["messages"][0]["content"] else answer(body)

    functionals = run(faucet, live, check=fails(first), transcript=tmp_path)

    assert len(functionals.fitness) == 2
    assert "still fails its check after 3 repairs" in functionals.dropped[0]
    assert len(api.bodies) == 5 + 3
    assert len(list(ExchangeFolder(tmp_path).exchanges())) == 5 + 3


@pytest.mark.usefixtures("no_network")
def test_in_replay_a_function_that_fails_is_dropped(faucet):
    recorded = run(faucet, ReplayProvider())
    first = recorded.quantities[0].name
    functionals = run(faucet, ReplayProvider(), check=fails(first))

    assert codes(functionals)["quantities"] == codes(recorded)["quantities"][1:]
    (sentence,) = functionals.dropped
    assert sentence.endswith("(KeyError in line 2: no such key), and no repair of it is recorded.")


@pytest.mark.usefixtures("no_network")
@pytest.mark.parametrize("kind", KINDS)
def test_kind_without_any_function_fails(faucet, kind):
    check = one_by_one(lambda its: CheckFailure("TypeError", "no") if its.kind == kind else None)
    wanted = "direct success" if kind == "direct" else f"{kind} function"
    with pytest.raises(InferenceError, match=f"^Expected a {wanted} that can be used, got none"):
        run(faucet, ReplayProvider(), check=check)


@pytest.mark.usefixtures("no_network")
def test_other_instruction_is_not_recorded(faucet):
    other = replace(faucet, instruction="Turn on the cold water")

    with pytest.raises(MissingRecordingError, match=r"the nearest is faucet-0\.json, but line 1"):
        run(other, ReplayProvider())


@pytest.mark.parametrize(
    ("text", "changes"),
    [("{", {}), ("{}", {}), ("{", {"stop_reason": "max_tokens"}), ("", {"stop_reason": "refusal"})],
)
def test_first_reply_that_cannot_be_read_fails_and_is_kept(
    faucet, scripted, words, tmp_path, text, changes
):
    bad = scripted(lambda _: words.message(text, **changes))
    with pytest.raises(ReplyError, match="success prompt"):
        run(faucet, bad, transcript=tmp_path)

    (kept,) = ExchangeFolder(tmp_path).exchanges()
    assert kept.answer.body == words.message(text, **changes)


def test_next_try_goes_on_where_the_last_one_failed(faucet, api, live, tmp_path):
    answer = api.answer
    failing = api.response({"error": {"message": "No."}}, status=529)
    api.answer = lambda body: failing if len(api.bodies) == 4 else answer(body)
    options = ModelOptions(max_retries=0)

    with pytest.raises(ProviderError, match="is overloaded"):
        run(faucet, live, options=options, transcript=tmp_path)
    assert len(api.bodies) == 4
    functionals = run(faucet, live, options=options, transcript=tmp_path)

    assert len(api.bodies) == 6
    assert codes(functionals) == codes(run(faucet, ReplayProvider()))
    assert functionals.usage.requests == 5
    run(faucet, live, options=options, transcript=tmp_path)
    assert len(api.bodies) == 6


def test_repairs_are_kept_too(faucet, repairing, tmp_path):
    check = fails(run(faucet, ReplayProvider()).fitness[0].name)
    first = run(faucet, repairing, check=check, transcript=tmp_path)
    asked = len(repairing.requests)
    second = run(faucet, repairing, check=check, transcript=tmp_path)

    assert len(repairing.requests) == asked == 7
    assert codes(second) == codes(first)
    assert second.repaired == first.repaired
    assert second.usage == first.usage == ExchangeFolder(tmp_path).usage()


def test_live_inference_is_recorded_and_replayed(faucet, api, live, tmp_path):
    recordings, transcript = tmp_path / "recordings", tmp_path / "transcript"
    record = KeepingProvider(live, folder=recordings)
    recorded = run(faucet, record, sample=9, transcript=transcript)

    replayed = run(faucet, ReplayProvider(recordings), sample=9)

    assert len(api.bodies) == 5
    assert codes(replayed) == codes(recorded)
    assert replayed.usage == recorded.usage
    assert "through the Anthropic API" in replayed.provenance
    files = [path for path in tmp_path.rglob("*") if path.is_file()]
    assert len(files) == 10
    assert not [path for path in files if KEY in path.read_text()]


def test_prompts_hold_nothing_but_the_task_and_what_the_check_said(faucet, repairing):
    check = fails(run(faucet, ReplayProvider()).fitness[0].name)
    run(faucet, repairing, check=check)
    repairs = [request for request in repairing.requests if request.attempt]

    assert len(repairs) == 2
    original = render_prompt("fitness", instruction=faucet.instruction)
    for request in repairs:
        prompt = request.messages[0].text
        assert prompt.startswith(f"{original}\n\n")
        said = [line for line in prompt.splitlines() if line.startswith("What a check of it found")]
        assert said == ["What a check of it found: KeyError in line 2: no such key"]


CHILD = """
import pathlib, sys
from lqd_envs.perception import ObjectJoint, PerceptionSchema
from lqd_llm import CheckOutcome, LiveProvider, infer

with LiveProvider() as provider:
    infer(
        instruction={instruction!r},
        schema={schema!r},
        provider=provider,
        check=lambda candidates: [CheckOutcome() for _ in candidates],
        transcript=pathlib.Path(sys.argv[1]),
    )
"""


def test_killed_inference_goes_on_where_it_was(faucet, api, live, tmp_path):
    answer = api.answer
    silent = api.response(fault="silent")
    api.answer = lambda body: silent if len(api.bodies) == 3 else answer(body)
    code = CHILD.format(instruction=faucet.instruction, schema=faucet.schema)
    keys = {"ANTHROPIC_API_KEY": KEY, "ANTHROPIC_BASE_URL": api.url}
    child = subprocess.Popen(
        [sys.executable, "-c", code, str(tmp_path)], env={**os.environ, **keys}
    )
    try:
        for _ in range(3):
            assert api.arrived.acquire(timeout=120)
    finally:
        child.kill()
        child.wait()

    assert len(list(ExchangeFolder(tmp_path).exchanges())) == 2
    functionals = run(faucet, live, transcript=tmp_path)

    assert codes(functionals) == codes(run(faucet, ReplayProvider()))
    asked = [body["messages"][0]["content"] for body in api.bodies]
    assert len(asked) == 6
    assert len(set(asked)) == 5
    assert asked[2] == asked[3]
