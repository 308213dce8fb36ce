import json
import os
from concurrent.futures import ThreadPoolExecutor

import pytest

from lqd_llm.answer import Answer
from lqd_llm.errors import RecordingError
from lqd_llm.exchange_folder import ExchangeFolder, is_usable
from lqd_llm.model_options import ModelOptions

GOOD = '{"functions": []}'


@pytest.fixture
def folder(tmp_path):
    return ExchangeFolder(tmp_path / "deep" / "exchanges")


@pytest.fixture
def answer(words):
    return Answer(words.message(GOOD), provenance="A test.", request_id="req_1", date="today")


def test_exchange_is_found_again_as_it_was(folder, answer, ask):
    request = ask("Wörds {CODE}\n", options=ModelOptions(effort="low", max_tokens=7), sample=2)
    folder.write(request, answer)

    kept = folder.find(request)

    assert kept.answer == answer
    assert kept.request == request
    assert kept.file_name == f"{request.key}.json"
    assert is_usable(kept)


def test_file_holds_everything_sent_and_received_in_plain_sight(folder, answer, ask):
    request = ask("Write", sample=1)
    folder.write(request, answer)

    text = (folder.path / f"{request.key}.json").read_text("ascii")
    content = json.loads(text)

    assert text.count("\n") > 20
    assert content["subject"] == "fitness"
    assert content["sent"]["messages"] == [{"role": "user", "content": "Write"}]
    assert content["sent"]["system"] == "Be brief."
    assert content["sent"]["schema"]["additionalProperties"] is False
    assert content["received"]["body"] == answer.body


def test_other_requests_are_not_found(folder, answer, ask):
    folder.write(ask("Write"), answer)

    assert folder.find(ask("Write", sample=1)) is None
    assert folder.find(ask("write")) is None


@pytest.mark.parametrize("body", ["<html>", None, [1.5], {"text": "\ud800"}, {"a": float("inf")}])
def test_whatever_came_can_be_kept(folder, ask, body):
    folder.write(ask(), Answer(body, provenance="A test."))

    kept = folder.find(ask())
    assert kept.answer.body == body
    assert not is_usable(kept)


def test_earlier_answers_are_moved_aside_and_still_counted(folder, words, ask):
    for text in ("one", "two", GOOD):
        folder.write(ask(), Answer(words.message(text), provenance="A test."))

    key = ask().key
    names = [f"{key}.1.json", f"{key}.2.json", f"{key}.json"]
    assert sorted(path.name for path in folder.path.iterdir()) == names
    assert [kept.answer.text for kept in folder.exchanges()] == ["one", "two", GOOD]
    assert folder.find(ask()).answer.text == GOOD
    assert folder.usage().requests == 3


def test_trying_whether_it_can_be_written_leaves_no_trace(folder, tmp_path):
    folder.require_writable()
    assert list(tmp_path.iterdir()) == []
    folder.path.mkdir(parents=True)
    folder.require_writable()
    assert list(folder.path.iterdir()) == []


def test_folder_that_cannot_be_written(tmp_path):
    (tmp_path / "file").touch()

    with pytest.raises(RecordingError) as caught:
        ExchangeFolder(tmp_path / "file").require_writable()
    assert str(caught.value) == (
        f"Expected a folder that answers can be written to, but {tmp_path / 'file'} is none (Not a "
        "directory); make room there or name another folder."
    )


def test_a_full_disk_is_found_out_before(folder, monkeypatch):
    def no_room(_: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", no_room)
    with pytest.raises(
        RecordingError, match=r"is none \(No space left on device\); make room there"
    ):
        folder.require_writable()


def test_a_path_that_cannot_be_looked_up(tmp_path, answer, ask):
    folder = ExchangeFolder(tmp_path / ("x" * 300))

    for use in (
        folder.require_writable,
        lambda: folder.find(ask()),
        lambda: folder.write(ask(), answer),
        lambda: list(folder.exchanges()),
    ):
        with pytest.raises(RecordingError, match=r"\(File name too long\)"):
            use()


def test_two_that_answer_the_same_at_once_lose_nothing(folder, words, ask):
    answers = [Answer(words.message(text), provenance="A test.") for text in "abcdefgh"]
    with ThreadPoolExecutor(len(answers)) as pool:
        list(pool.map(lambda answer: folder.write(ask(), answer), answers))

    assert sorted(kept.answer.text for kept in folder.exchanges()) == list("abcdefgh")


def test_missing_folder_is_empty(folder, ask):
    assert folder.find(ask()) is None
    assert list(folder.exchanges()) == []
    assert folder.usage().requests == 0


def test_other_files_are_left_alone(folder, answer, ask):
    folder.write(ask(), answer)
    for name in ("faucet-0.json", "notes.txt", f".{ask().key}.json.part"):
        (folder.path / name).write_text("{")

    assert len(list(folder.exchanges())) == 1


def test_write_that_fails_leaves_nothing_half_done(folder, answer, ask, monkeypatch):
    def no_room(_: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", no_room)
    with pytest.raises(RecordingError) as caught:
        folder.write(ask(), answer)

    assert "(No space left on device); make room there or name another folder." in str(caught.value)
    assert list(folder.path.iterdir()) == []


def no_sent(content):
    del content["sent"]


def extra(content):
    content["note"] = ""


def sample_as_text(content):
    content["sent"]["sample"] = "0"


def effort(content):
    content["sent"]["effort"] = "extreme"


def limit(content):
    content["sent"]["max_tokens"] = 0


def other_key(content):
    content["key"] = "0" * 64


def other_prompt(content):
    content["sent"]["messages"][0]["content"] = "Read"


@pytest.mark.parametrize(
    ("change", "problem"),
    [
        (no_sent, "at sent: Field required"),
        (extra, "at note: Extra inputs are not permitted"),
        (sample_as_text, "at sent.sample: Input should be a valid integer"),
        (effort, "at sent.effort: Input should be 'low'"),
        (limit, "at sent: Expected max_tokens of at least 1"),
        (other_key, "since what was sent has the key"),
        (other_prompt, "since what was sent has the key"),
    ],
)
def test_other_forms_are_refused(folder, answer, ask, change, problem):
    folder.write(ask(), answer)
    path = folder.path / f"{ask().key}.json"
    content = json.loads(path.read_text())
    change(content)
    path.write_text(json.dumps(content))

    with pytest.raises(RecordingError) as caught:
        folder.find(ask())

    assert f"The recording {path.name} is not of the right form {problem}" in str(caught.value)


@pytest.mark.parametrize("content", [b"", b"{", b"\xff\xfe", b"[" * 100_000])
def test_other_than_json_is_refused(folder, answer, ask, content):
    folder.write(ask(), answer)
    (folder.path / f"{ask().key}.json").write_bytes(content)

    with pytest.raises(RecordingError, match="is not of the right form since it is not JSON"):
        folder.find(ask())


def test_a_folder_that_cannot_be_read_is_no_file_to_remove(folder):
    folder.path.parent.mkdir()
    folder.path.symlink_to(folder.path)

    with pytest.raises(RecordingError, match=r"^The folder .* cannot be read \(Too many levels"):
        list(folder.exchanges())
    with pytest.raises(RecordingError, match=r"but .* is none \(Too many levels"):
        folder.require_writable()


def test_a_folder_in_its_place_is_refused(folder, ask):
    (folder.path / f"{ask().key}.json").mkdir(parents=True)

    with pytest.raises(RecordingError, match=r"cannot be read \(Is a directory\); restore or"):
        folder.find(ask())
