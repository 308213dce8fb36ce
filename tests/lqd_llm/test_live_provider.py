import json
import logging
import traceback

import anthropic
import anthropic._base_client
import httpx2
import pytest
from anthropic import Anthropic

from lqd_envs.errors import LQDError
from lqd_llm.answer import read_reply
from lqd_llm.errors import InferenceError, ProviderError, ReplyError
from lqd_llm.live_provider import LiveProvider
from lqd_llm.model_options import MOST_TOKENS, ModelOptions
from lqd_llm.request import Turn, reply_schema

KEY = "sk-ant-test-0123456789"
GOOD = json.dumps({"functions": [{"name": "a", "description": "b", "code": "c"}]})

pytestmark = pytest.mark.usefixtures("no_credentials")


@pytest.fixture
def live(api):
    with LiveProvider(Anthropic(api_key=KEY, base_url=api.url)) as provider:
        yield provider


@pytest.fixture
def fail(live, ask):
    """A function that asks in vain and returns the sentence that says why."""

    def ask_in_vain(provider=live, **options):
        with pytest.raises(ProviderError) as caught:
            provider.ask(ask(options=ModelOptions(**options)))
        told = "".join(traceback.format_exception(caught.value))
        # The errors of the SDK hold the key in the headers of their request.
        assert caught.value.__context__ is None
        assert KEY not in told
        assert "sk-" not in told
        sentence = str(caught.value)
        assert sentence.endswith(".")
        assert "\n" not in sentence
        return sentence

    return ask_in_vain


def error(api, status, message="Something is wrong.", **headers):
    body = {"type": "error", "error": {"type": "some_error", "message": message}}
    return api.response(body, status=status, headers=headers)


def good(api, words):
    return api.response(words.message(GOOD), headers={"date": "Sun, 22 Nov 2026 10:00:00 GMT"})


def test_request_and_answer(api, live, ask, words):
    api.script.append(good(api, words))
    turns = (Turn("user", "Write"), Turn("assistant", "No"), Turn("user", "Do"))
    request = ask(messages=turns, options=ModelOptions(effort="high", max_tokens=123))

    answer = live.ask(request)

    assert read_reply(answer, request=request).functions[0].name == "a"
    assert answer.body == words.message(GOOD)
    assert (answer.request_id, answer.model) == ("req_1", "claude-opus-5-5")
    assert answer.date is not None
    assert "through the Anthropic API" in answer.provenance
    assert api.headers[0]["authorization"] == f"Bearer {KEY}"
    assert api.bodies == [
        {
            "model": "claude-opus-5-5",
            "max_tokens": 123,
            "system": [
                {"type": "text", "text": "Be brief.", "cache_control": {"type": "ephemeral"}}
            ],
            "messages": [
                {"role": "user", "content": "Write"},
                {"role": "assistant", "content": "No"},
                {"role": "user", "content": "Do"},
            ],
            "output_config": {
                "effort": "high",
                "format": {"type": "json_schema", "schema": reply_schema()},
            },
        }
    ]


def test_effort_is_left_out_by_default(api, live, ask, words):
    api.script.append(good(api, words))
    live.ask(ask())

    assert set(api.bodies[0]["output_config"]) == {"format"}


def test_largest_limit_needs_no_streaming(api, live, ask, words):
    api.script.append(good(api, words))
    live.ask(ask(options=ModelOptions(max_tokens=MOST_TOKENS)))

    assert api.bodies[0]["max_tokens"] == MOST_TOKENS == 21_333
    # As the SDK reckons, which refuses more where it may choose the time-out.
    live._client._calculate_nonstreaming_timeout(MOST_TOKENS, None)
    with pytest.raises(ValueError, match="Streaming is required"):
        live._client._calculate_nonstreaming_timeout(MOST_TOKENS + 1, None)


def test_larger_limit_is_not_asked_for(api, fail):
    assert fail(max_tokens=MOST_TOKENS + 1) == (
        "Expected max_tokens of at most 21,333, about what comes within ten minutes, but got "
        "21,334; lower it, and the effort where replies are cut."
    )
    assert api.bodies == []


def test_rate_limit_is_waited_out(api, live, ask, words, sleeps):
    limited = error(api, 429, **{"retry-after": "7"})
    api.script.extend([limited, limited, good(api, words)])

    assert live.ask(ask()).text == GOOD
    assert sleeps == [7.0, 7.0]
    assert len(api.bodies) == 3


@pytest.mark.parametrize("status", [408, 409, 500, 502, 503, 529])
def test_faults_that_pass_are_waited_out(api, live, ask, words, sleeps, status):
    api.script.extend([error(api, status), good(api, words)])

    assert live.ask(ask()).text == GOOD
    assert len(sleeps) == 1
    assert 0 < sleeps[0] <= 0.5


@pytest.mark.parametrize("fault", ["dropped", "torn"])
def test_dropped_connection_is_made_again(api, live, ask, words, sleeps, fault):
    api.script.extend([api.response({"type": "message"}, fault=fault), good(api, words)])

    assert live.ask(ask()).text == GOOD
    assert len(sleeps) == 1


def test_rate_limit_without_end(api, fail, sleeps):
    api.answer = lambda _: error(api, 429, "Too many tokens a minute.", **{"retry-after": "30"})

    assert fail(max_retries=2) == (
        "The Anthropic API refused the fitness prompt because of a rate limit, 3 times in a row "
        "('Too many tokens a minute', request req_1); try again in 30 seconds."
    )
    assert sleeps == [30.0, 30.0]
    assert len(api.bodies) == 3


def test_fault_that_the_api_says_will_stay_is_not_said_to_be_tried_again(api, fail, sleeps):
    no_more = {"x-should-retry": "false", "retry-after": "30"}
    again = {"x-should-retry": "true", "retry-after": "1"}
    api.script.extend([error(api, 429, **no_more), error(api, 429, **again)])
    api.answer = lambda _: error(api, 429, **no_more)

    assert fail() == (
        "The Anthropic API refused the fitness prompt because of a rate limit ('Something is "
        "wrong', request req_1); try again in 30 seconds."
    )
    assert ", 2 times in a row ('Something" in fail()
    assert sleeps == [1.0]


def test_rate_limit_that_names_no_time(api, fail):
    api.script.append(error(api, 429))

    assert fail(max_retries=0).endswith("; try again in a minute.")


@pytest.mark.parametrize(
    ("status", "sentence"),
    [
        (
            529,
            "The Anthropic API is overloaded, 2 times in a row ('Something is wrong', request "
            "req_1); try again in some minutes.",
        ),
        (
            500,
            "The Anthropic API failed with status 500, 2 times in a row ('Something is wrong', "
            "request req_1); try again in some minutes, and see https://status.claude.com.",
        ),
    ],
)
def test_fault_of_the_server_without_end(api, fail, sleeps, status, sentence):
    api.answer = lambda _: error(api, status)

    assert fail(max_retries=1) == sentence
    assert len(sleeps) == 1


@pytest.mark.parametrize(
    ("status", "sentence"),
    [
        (
            400,
            "The Anthropic API does not accept the fitness prompt ('Your credit balance is too "
            "low', request req_1); change the option or the account setting that it names.",
        ),
        (402, "The Anthropic API asks for payment ("),
        (403, "The key may not use the model 'claude-opus-5-5' ("),
        (404, "The Anthropic API knows no model 'claude-opus-5-5' ("),
        (413, "The fitness prompt is too large for the Anthropic API ("),
        (418, "The Anthropic API answered the fitness prompt with status 418 ("),
    ],
)
def test_faults_that_stay_are_not_tried_again(api, fail, status, sentence):
    api.script.append(error(api, status, "Your credit\n balance is too low."))

    assert fail().startswith(sentence)
    assert len(api.bodies) == 1


def test_long_message_is_shortened(api, fail):
    api.script.append(error(api, 400, "long " * 1000))

    assert len(fail()) < 700


@pytest.mark.parametrize("body", [b"<html>no</html>", b"", b"[1]", b'{"error": 3}'])
def test_error_that_is_not_the_apis(api, fail, body):
    api.script.append(api.response(body, status=403))

    told = "The key may not use the model 'claude-opus-5-5' (request req_1); ask another"
    assert fail().startswith(told)


def test_wrong_key(api, fail):
    api.script.append(error(api, 401, f"invalid x-api-key {KEY}"))

    assert fail() == (
        "The Anthropic API does not accept the key ('invalid x-api-key [key]', request req_1); set "
        "ANTHROPIC_API_KEY to a key from https://platform.claude.com."
    )
    assert len(api.bodies) == 1


def test_missing_key(api, fail):
    with LiveProvider(Anthropic(base_url=api.url)) as provider:
        assert fail(provider) == (
            "Expected a key for the Anthropic API, but found none; set ANTHROPIC_API_KEY to a key "
            "from https://platform.claude.com, or take the recorded replies with `--llm replay`, "
            "which need none but are of the tasks' own instructions only."
        )
    assert api.bodies == []


@pytest.mark.parametrize("key", [f"{KEY}\n", f" {KEY}", f"{KEY}…", f"{KEY}\0", f"{KEY}\r\nX: y"])
def test_key_that_cannot_be_sent(api, fail, key):
    with LiveProvider(Anthropic(api_key=key, base_url=api.url)) as provider:
        told = fail(provider)

    assert told.startswith("Expected a key for the Anthropic API in plain characters, but it holds")
    assert api.bodies == []


def test_key_is_found_in_the_environment(api, ask, words, monkeypatch):
    monkeypatch.setenv("ANTHROPIC_API_KEY", KEY)
    monkeypatch.setenv("ANTHROPIC_BASE_URL", api.url)
    api.script.append(good(api, words))
    with LiveProvider() as provider:
        provider.ask(ask())

    assert api.headers[0]["authorization"] == f"Bearer {KEY}"


def test_credentials_that_cannot_be_loaded(monkeypatch):
    monkeypatch.setenv("ANTHROPIC_PROFILE", "no-such-profile")

    with pytest.raises(
        ProviderError, match=r"cannot be loaded \(\w+\); set ANTHROPIC_API_KEY to a key"
    ):
        LiveProvider()


@pytest.mark.parametrize(
    ("name", "value", "why"),
    [
        ("SSL_CERT_FILE", "/nonexistent", "No such file or directory"),
        ("HTTPS_PROXY", "ftp://user:secret@host", "ValueError"),
    ],
)
def test_connection_that_cannot_be_set_up(monkeypatch, name, value, why):
    monkeypatch.setenv("ANTHROPIC_API_KEY", KEY)
    monkeypatch.setenv(name, value)

    with pytest.raises(ProviderError) as caught:
        LiveProvider()
    assert str(caught.value) == (
        f"The connection to the Anthropic API cannot be set up ({why}); check SSL_CERT_FILE, "
        "SSL_CERT_DIR and any proxy."
    )
    assert caught.value.__context__ is None


def test_other_type_errors_are_not_hidden(live, ask, monkeypatch):
    def broken(**_):
        raise TypeError("a mistake of ours")

    monkeypatch.setattr(anthropic.resources.Messages, "create", broken)
    with pytest.raises(TypeError):
        live.ask(ask())


def test_server_that_never_answers(api, fail):
    api.answer = lambda _: api.response(fault="silent")

    assert fail(timeout=0.1, max_retries=0) == (
        "The Anthropic API did not answer the fitness prompt within 0.1 seconds; try again, or "
        "lower the effort."
    )


def test_time_out_is_tried_again(api, live, ask, words, sleeps):
    api.script.extend([api.response(fault="silent"), good(api, words)])

    assert live.ask(ask(options=ModelOptions(timeout=2.0))).text == GOOD
    assert len(sleeps) == 1


@pytest.mark.parametrize("fault", ["dropped", "torn"])
def test_connection_that_always_drops(api, fail, sleeps, fault):
    api.answer = lambda _: api.response({"type": "message"}, fault=fault)

    told = fail(max_retries=1)

    assert told.startswith("The connection to 127.0.0.1 failed (")
    assert told.endswith(
        "Error), 2 times in a row; check the network, any proxy and ANTHROPIC_BASE_URL, and try "
        "again."
    )
    assert len(sleeps) == 1


def test_nobody_there(fail, sleeps):
    def refuse(_):
        raise httpx2.ConnectError(f"Illegal header value {KEY!r}")

    transport = httpx2.Client(transport=httpx2.MockTransport(refuse))
    with LiveProvider(Anthropic(api_key=KEY, http_client=transport)) as provider:
        told = fail(provider)

    assert told.startswith("The connection to api.anthropic.com failed (ConnectError), 5 times")
    assert len(sleeps) == 4


@pytest.mark.parametrize(
    ("text", "changes", "sentence"),
    [
        (GOOD[:20], {"stop_reason": "max_tokens"}, "was cut at the limit of 20,000 tokens; raise"),
        ("", {"stop_reason": "refusal", "content": []}, "refused to answer the fitness prompt"),
        (GOOD[:20], {}, "is not JSON (EOF while parsing"),
        ('{"functions": {}}', {}, "is JSON of another form than was asked for, at functions"),
    ],
)
def test_reply_that_cannot_be_used_is_handed_over_whole(
    api, live, ask, words, text, changes, sentence
):
    body = words.message(text, **changes)
    api.script.append(api.response(body))

    answer = live.ask(ask())

    assert answer.body == body
    with pytest.raises(ReplyError) as caught:
        read_reply(answer, request=ask())
    assert sentence in str(caught.value)
    assert len(api.bodies) == 1


@pytest.mark.parametrize("body", [b"<html>", b'{"id": "msg_1"', b"", b"\xff", b"[" * 100_000])
def test_answer_that_is_not_json_is_handed_over_as_text(api, live, ask, body):
    api.script.append(api.response(body))

    answer = live.ask(ask())

    assert isinstance(answer.body, str)
    with pytest.raises(ReplyError, match="is not JSON, so it does not come from the Anthropic API"):
        read_reply(answer, request=ask())


def test_logs_do_not_hold_the_key(api, live, ask, words, caplog):
    api.script.append(good(api, words))
    with caplog.at_level(logging.DEBUG):
        live.ask(ask())

    assert "/v1/messages" in caplog.text
    assert KEY not in caplog.text


def test_errors_are_of_the_project():
    assert issubclass(ProviderError, InferenceError)
    assert issubclass(ProviderError, LQDError)
