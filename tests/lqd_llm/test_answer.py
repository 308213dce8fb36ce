import json

import pytest

from lqd_envs.errors import LQDError
from lqd_llm.answer import Answer, is_complete, read_reply
from lqd_llm.errors import InferenceError, ReplyError
from lqd_llm.model_options import MOST_TOKENS, ModelOptions

FUNCTION = {"name": "a", "description": "", "code": "def fitness(info): return 0.0"}
GOOD = json.dumps({"functions": [FUNCTION]})


@pytest.fixture
def read(ask):
    def read_body(body):
        return read_reply(Answer(body, provenance=""), request=ask())

    return read_body


@pytest.fixture
def problem(read, ask):
    def told(body):
        with pytest.raises(ReplyError) as caught:
            read(body)
        assert not is_complete(Answer(body, provenance=""), request=ask())
        return str(caught.value)

    return told


def test_functions_are_read_from_the_text(read, words, ask):
    body = words.message(GOOD)

    assert read(body).functions[0].code == FUNCTION["code"]
    assert is_complete(Answer(body, provenance=""), request=ask())


def test_text_in_several_blocks_is_put_together(read, words):
    blocks = [words.text_block(GOOD[:20]), {"type": "other"}, words.text_block(GOOD[20:])]

    assert len(read(words.message("", content=blocks)).functions) == 1


def test_refusal_quotes_what_the_api_says(problem, words):
    details = {"type": "refusal", "category": "bio", "explanation": "Not this."}

    assert problem(words.message("", stop_reason="refusal", stop_details=details)) == (
        "The model claude-opus-5-5 refused to answer the fitness prompt (bio: Not this.); word the "
        "instruction differently or ask another model."
    )


@pytest.mark.parametrize("details", [None, {}, {"category": None, "explanation": None}])
def test_refusal_without_a_reason(problem, words, details):
    told = problem(words.message(GOOD, stop_reason="refusal", stop_details=details))

    assert told.startswith("The model claude-opus-5-5 refused to answer the fitness prompt; word")


def test_reply_that_was_cut(problem, words):
    assert problem(words.message(GOOD[:30], stop_reason="max_tokens")) == (
        "The reply to the fitness prompt was cut at the limit of 20,000 tokens; raise max_tokens "
        "or lower the effort."
    )
    told = problem(words.message(GOOD, stop_reason="model_context_window_exceeded"))
    assert told.endswith("ask a model with a larger context window.")


def test_reply_that_was_cut_at_the_largest_limit(words, ask):
    request = ask(options=ModelOptions(max_tokens=MOST_TOKENS))
    answer = Answer(words.message(GOOD[:30], stop_reason="max_tokens"), provenance="")

    with pytest.raises(ReplyError, match=r"at the limit of 21,333 tokens; lower the effort\.$"):
        read_reply(answer, request=request)


@pytest.mark.parametrize("reason", ["tool_use", "pause_turn", None, 3])
def test_reply_that_did_not_end(problem, words, reason):
    assert "did not come to its end (its stop_reason is" in problem(
        words.message(GOOD, stop_reason=reason)
    )


def test_reply_without_text(problem, words):
    assert problem(words.message("", content=[])) == (
        "The reply to the fitness prompt holds no text; try again or ask another model."
    )
    assert "holds no text" in problem(words.message("", content=[{"type": "text", "text": 3}]))


@pytest.mark.parametrize("text", ["", "Here you are:", GOOD[:-1], '{"functions": ["\\ud800"]}'])
def test_reply_that_is_not_json(problem, words, text):
    told = problem(words.message(text))

    assert told.startswith("The reply to the fitness prompt is not JSON (")
    assert told.endswith("; try again or ask another model.")
    assert "\n" not in told


@pytest.mark.parametrize(
    ("content", "place"),
    [
        ([], "the top level: Input should be an object"),
        ({"function": []}, "functions: Field required"),
        ({"functions": [{**FUNCTION, "code": None}]}, "functions.0.code: Input should be a valid"),
        ({"functions": [{**FUNCTION, "entry": ""}]}, "functions.0.entry: Extra inputs"),
    ],
)
def test_json_of_another_form(problem, words, content, place):
    told = problem(words.message(json.dumps(content)))

    assert f"is JSON of another form than was asked for, at {place}" in told


@pytest.mark.parametrize("body", ["<html>", None, [GOOD], 3])
def test_answer_that_is_not_from_the_api(problem, body):
    assert problem(body) == (
        "The reply to the fitness prompt is not JSON, so it does not come from the Anthropic API; "
        "check ANTHROPIC_BASE_URL and any proxy, and try again."
    )


def test_errors_are_of_the_project():
    assert issubclass(ReplyError, InferenceError)
    assert issubclass(ReplyError, LQDError)


def test_answer_says_who_answered_and_what_it_took(words):
    answer = Answer(words.message(GOOD), provenance="")

    assert (answer.model, answer.stop_reason) == ("claude-opus-5-5", "end_turn")
    assert answer.usage.input_tokens == 100
    assert Answer("<html>", provenance="").model == "unknown"
    assert Answer("<html>", provenance="").usage.unreported == 1
