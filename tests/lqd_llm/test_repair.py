import json

import pytest

from lqd_llm import Candidate, CheckFailure, CheckOutcome, FunctionSource
from lqd_llm.errors import FunctionError, MissingRecordingError, ProviderError
from lqd_llm.inquiry import Inquiry
from lqd_llm.model_options import ModelOptions
from lqd_llm.repair import MAX_REPAIRS
from lqd_llm.repair import repair as repair_function

SOURCE = FunctionSource(name="reach", description="How near.", code="def fitness(info): bad 0\n")


def check(candidates):
    """Fail while the code says `bad`, which it says with a number."""
    (candidate,) = candidates
    assert (candidate.kind, candidate.entry) == ("fitness", "fitness")
    code = candidate.source.code
    if "bad" not in code:
        return [CheckOutcome()]
    missing = code.split("bad ")[1].strip()
    return [CheckOutcome(CheckFailure("KeyError", f"there is no {missing}.", line=1))]


def after_check(source, *, check=check, **arguments):
    """Repair a function that has been checked once."""
    candidate = Candidate(source, "fitness", "fitness")
    (outcome,) = check([candidate])
    return repair_function(candidate, outcome, check=check, **arguments)


@pytest.fixture
def repair(scripted):
    """A function that repairs with a scripted model and returns what came and what was asked."""

    def run(*replies, source=SOURCE, check=check):
        texts = iter(replies)
        model = scripted(lambda _: next(texts))
        inquiry = Inquiry(model, options=ModelOptions(), system="Be brief.", sample=2)
        try:
            return (
                after_check(source, check=check, prompt="Write {NAME}.", inquiry=inquiry),
                model,
            )
        except FunctionError as error:
            return error, model

    return run


@pytest.fixture
def fixed(words):
    return words.reply_text(("other_name", "def fitness(info): return 1.0"))


@pytest.fixture
def worse(words):
    def reply(number):
        return words.reply_text(("reach", f"def fitness(info): bad {number}"))

    return reply


def test_function_that_passes_is_not_touched(repair):
    good = SOURCE.model_copy(update={"code": "good"})
    checked, model = repair(source=good)

    assert checked.candidate.source is good
    assert checked.report is None
    assert model.requests == []


def test_function_passes_after_one_repair(repair, fixed):
    checked, model = repair(fixed)

    assert checked.candidate.source.code == "def fitness(info): return 1.0"
    assert checked.candidate.source.name == "reach"
    assert checked.candidate.source.description == "what other_name does"
    assert checked.report == (
        "The fitness function 'reach' passes its check after 1 repair "
        "(before: KeyError in line 1: there is no 0)."
    )
    assert len(model.requests) == 1


def test_repair_is_told_the_function_and_what_failed(repair, fixed):
    _, model = repair(fixed)
    (request,) = model.requests
    (turn,) = request.messages

    assert (request.system, request.sample, request.attempt) == ("Be brief.", 2, 1)
    assert request.subject == "fitness repair"
    assert turn.role == "user"
    assert turn.text.startswith("Write {NAME}.\n\n")
    assert "```python\ndef fitness(info): bad 0\n```" in turn.text
    assert "KeyError in line 1: there is no 0\n" in turn.text
    assert "How near." in turn.text
    assert turn.text.endswith("which is called `fitness`.")


def test_next_repair_starts_from_the_last_one(repair, worse, fixed):
    checked, model = repair(worse(1), worse(2), fixed)

    assert checked.report.startswith("The fitness function 'reach' passes its check after 3 repair")
    prompts = [request.messages[0].text for request in model.requests]
    assert [f"bad {number}" in prompt for number, prompt in enumerate(prompts)] == [True] * 3
    assert [f"there is no {number}" in p for number, p in enumerate(prompts)] == [True] * 3
    assert [request.attempt for request in model.requests] == [1, 2, 3]


def test_function_that_never_passes_is_given_up(repair, worse):
    error, model = repair(*map(worse, range(1, 9)))

    assert str(error) == (
        "The fitness function 'reach' is not used: it still fails its check after 3 repairs "
        "(KeyError in line 1: there is no 3)."
    )
    assert len(model.requests) == MAX_REPAIRS == 3


def test_reply_that_cannot_be_read_is_a_repair_that_failed(repair, words, fixed):
    refused = words.message("", stop_reason="refusal", content=[])
    checked, model = repair(refused, "no JSON", fixed)

    assert checked.candidate.source.code == "def fitness(info): return 1.0"
    assert len({request.key for request in model.requests}) == 3
    assert len({request.messages for request in model.requests}) == 1


def test_empty_reply_is_a_repair_that_failed(repair):
    error, model = repair(*[json.dumps({"functions": []})] * 3)

    assert "after 3 repairs (KeyError in line 1: there is no 0)" in str(error)
    assert len(model.requests) == 3


def test_failure_without_a_line(repair, fixed):
    def once(candidates):
        bad = "bad" in candidates[0].source.code
        return [CheckOutcome(CheckFailure("Rejected", "too long") if bad else None)]

    checked, model = repair(fixed, check=once)

    assert checked.report.endswith("(before: Rejected: too long).")
    assert "Rejected: too long\n" in model.requests[0].messages[0].text


def test_without_a_recorded_repair_the_function_is_given_up(scripted):
    def nothing(_):
        raise MissingRecordingError("no")

    inquiry = Inquiry(scripted(nothing), options=ModelOptions(), system="", sample=0)
    with pytest.raises(FunctionError) as caught:
        after_check(SOURCE, prompt="", inquiry=inquiry)

    assert str(caught.value) == (
        "The fitness function 'reach' is not used: it fails its check (KeyError in line 1: there "
        "is no 0), and no repair of it is recorded."
    )


def test_fault_of_the_model_is_not_a_failed_repair(scripted):
    def fault(_):
        raise ProviderError("overloaded")

    inquiry = Inquiry(scripted(fault), options=ModelOptions(), system="", sample=0)
    with pytest.raises(ProviderError, match="overloaded"):
        after_check(SOURCE, prompt="", inquiry=inquiry)
