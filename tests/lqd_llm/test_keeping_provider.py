import pytest

from lqd_llm.errors import ProviderError
from lqd_llm.exchange_folder import ExchangeFolder
from lqd_llm.keeping_provider import KeepingProvider
from lqd_llm.model_options import ModelOptions
from lqd_llm.replay_provider import ReplayProvider

GOOD = '{"functions": []}'


def test_answer_is_asked_for_once(scripted, tmp_path, ask):
    model = scripted(lambda _: GOOD)

    first = KeepingProvider(model, folder=tmp_path).ask(ask())
    second = KeepingProvider(model, folder=tmp_path).ask(ask())

    assert first == second
    assert len(model.requests) == 1


def test_other_requests_are_asked(scripted, tmp_path, ask):
    model = scripted(lambda _: GOOD)
    provider = KeepingProvider(model, folder=tmp_path)
    requests = [ask(), ask(sample=1), ask(attempt=1), ask(options=ModelOptions(effort="low"))]
    for request in requests:
        provider.ask(request)

    assert model.requests == requests


def test_what_cannot_be_read_is_kept_and_asked_again(scripted, tmp_path, words, ask):
    texts = iter(["not JSON", words.message(GOOD, stop_reason="max_tokens"), GOOD])
    model = scripted(lambda _: next(texts))
    provider = KeepingProvider(model, folder=tmp_path)
    answers = [provider.ask(ask()) for _ in range(4)]

    assert [answer.text for answer in answers] == ["not JSON", GOOD, GOOD, GOOD]
    assert answers[2] == answers[3]
    assert len(model.requests) == 3
    assert len(list(ExchangeFolder(tmp_path).exchanges())) == 3


def test_larger_limit_does_not_ask_for_what_is_there(scripted, tmp_path, ask):
    model = scripted(lambda _: GOOD)
    provider = KeepingProvider(model, folder=tmp_path)
    provider.ask(ask(options=ModelOptions(max_tokens=10)))
    provider.ask(ask(options=ModelOptions(max_tokens=20)))

    assert len(model.requests) == 1


def test_fault_keeps_nothing(scripted, tmp_path, ask):
    def fail(_):
        raise ProviderError("no")

    with pytest.raises(ProviderError):
        KeepingProvider(scripted(fail), folder=tmp_path).ask(ask())
    assert list(tmp_path.iterdir()) == []


def test_replay_finds_what_was_recorded(scripted, tmp_path, ask):
    recorded = KeepingProvider(scripted(lambda _: GOOD), folder=tmp_path).ask(ask())

    assert ReplayProvider(tmp_path).ask(ask()) == recorded
