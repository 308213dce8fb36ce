import pytest

from lqd_llm.errors import ProviderError, RecordingError
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


def test_what_is_kept_is_copied(scripted, tmp_path, ask):
    model = scripted(lambda _: GOOD)
    folders = [tmp_path / name for name in ("first", "second")]
    provider = KeepingProvider(model, folder=folders[0], copies=folders[1:])

    answer = provider.ask(ask())
    assert provider.ask(ask()) == answer
    assert [len(list(ExchangeFolder(folder).exchanges())) for folder in folders] == [1, 1]
    for folder in folders:
        (folder / f"{ask().key}.json").unlink()
        assert provider.ask(ask()) == answer
    assert [len(list(ExchangeFolder(folder).exchanges())) for folder in folders] == [1, 1]
    assert len(model.requests) == 1


@pytest.mark.parametrize("place", ["folder", "copies"])
def test_nothing_is_asked_where_it_cannot_be_kept(scripted, tmp_path, ask, place):
    model = scripted(lambda _: GOOD)
    (tmp_path / "file").touch()
    good, bad = tmp_path / "good", tmp_path / "file" / "folder"
    folder, copy = (bad, good) if place == "folder" else (good, bad)

    with pytest.raises(RecordingError, match=r"that answers can be written to, but .*folder is no"):
        KeepingProvider(model, folder=folder, copies=[copy]).ask(ask())
    assert model.requests == []
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_what_cannot_be_copied_is_kept_all_the_same(scripted, tmp_path, ask, monkeypatch):
    model = scripted(lambda _: GOOD)
    first, second = tmp_path / "first", tmp_path / "second"
    provider = KeepingProvider(model, folder=first, copies=[second])
    # It could be written when that was tried, and can no more when it matters.
    monkeypatch.setattr(ExchangeFolder, "require_writable", lambda _: second.touch())

    with pytest.raises(RecordingError, match=r"cannot be written to .*second"):
        provider.ask(ask())
    second.unlink()
    answer = provider.ask(ask())

    assert len(model.requests) == 1
    assert ExchangeFolder(second).find(ask()).answer == answer


def test_what_the_first_folder_has_no_room_for_is_kept_in_the_other(
    scripted, tmp_path, ask, monkeypatch
):
    model = scripted(lambda _: GOOD)
    first, second = tmp_path / "first", tmp_path / "second"
    provider = KeepingProvider(model, folder=first, copies=[second])
    monkeypatch.setattr(ExchangeFolder, "require_writable", lambda _: first.touch())

    with pytest.raises(RecordingError, match=r"cannot be written to .*first"):
        provider.ask(ask())
    assert ExchangeFolder(second).find(ask()) is not None
    first.unlink()
    provider.ask(ask())

    assert len(model.requests) == 1
    assert ExchangeFolder(first).find(ask()) is not None


def test_replay_finds_what_was_recorded(scripted, tmp_path, ask):
    recorded = KeepingProvider(scripted(lambda _: GOOD), folder=tmp_path).ask(ask())

    assert ReplayProvider(tmp_path).ask(ask()) == recorded
