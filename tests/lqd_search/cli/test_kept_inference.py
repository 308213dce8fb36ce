"""Where answers are kept until an inference is complete."""

import fcntl
import os
from contextlib import contextmanager

import pytest

from lqd_envs import LQDError, get_task
from lqd_search.cli.kept_inference import keep_inference
from lqd_search.cli.llm_options import LLMOptions

FAUCET, DRAWER = get_task("LQD/Faucet-v0"), get_task("LQD/Drawer-v0")
LIVE = LLMOptions("live")


@pytest.fixture
def keep(tmp_path):
    @contextmanager
    def keep(task=FAUCET, *, llm=LIVE, instruction="Wave", sample=0, output=None):
        output = output or tmp_path / "runs" / "one"
        with keep_inference(output, task, llm=llm, instruction=instruction, sample=sample) as kept:
            yield kept

    return keep


def during(kept_inference, *acts):
    """Do something during an inference; return the folder in which it is kept."""
    with kept_inference as kept:
        for act in acts:
            act(kept)
    return kept.path


def answer(kept):
    kept.path.mkdir(parents=True, exist_ok=True)
    (kept.path / "answer").touch()


def fail(_):
    raise LQDError("overload")


def test_complete_inference_is_moved_into_the_output(keep, tmp_path):
    output = tmp_path / "runs" / "one"
    for llm in (LIVE, LLMOptions()):
        with keep(llm=llm) as kept:
            kept.path.mkdir(exist_ok=True)
            (kept.path / "answer").touch()
            output.mkdir()
            assert kept.path.parent == output.parent
            kept.move_into(output)
        assert [path.name for path in output.parent.iterdir()] == ["one"]
        (output / "inference" / "answer").unlink()
        (output / "inference").rmdir()
        output.rmdir()


def test_the_same_question_has_the_same_folder_and_another_has_another(keep, tmp_path):
    def path(**changes):
        with keep(**changes) as kept:
            return kept.path

    asked = [
        {},
        {"task": DRAWER},
        {"instruction": "Bow"},
        {"sample": 1},
        {"llm": LLMOptions("record")},
        {"llm": LLMOptions("live", model="other")},
        {"llm": LLMOptions("live", effort="low")},
    ]
    paths = [path(**changes) for changes in asked]

    assert len(set(paths)) == len(asked)
    assert paths == [path(**changes) for changes in asked]
    # What only limits a reply is no other question.
    assert path(llm=LLMOptions("live", max_tokens=5)) == paths[0]
    assert path(output=tmp_path / "runs" / "two") == paths[0]
    assert {path.name[:11] for path in paths} == {".inference-"}


def test_answers_of_a_model_survive_a_failure(keep, capsys):
    with pytest.raises(LQDError, match="overload"):
        during(keep(), answer, fail)
    told = capsys.readouterr().err
    with keep() as again:
        assert [path.name for path in again.path.iterdir()] == ["answer"]

    assert told == (
        f"note: the answers that came are kept in {again.path} and used when the same is asked "
        "again\n"
    )


@pytest.mark.parametrize("llm", [LIVE, LLMOptions()], ids=["live", "replay"])
def test_nothing_is_left_where_nothing_was_answered(keep, tmp_path, capsys, llm):
    with pytest.raises(LQDError, match="overload"):
        during(keep(llm=llm), fail)

    assert not list(tmp_path.iterdir())
    assert capsys.readouterr().err == ""


def test_what_recordings_answered_goes_with_a_failure(keep, tmp_path):
    with pytest.raises(LQDError, match="overload"):
        during(keep(llm=LLMOptions()), answer, fail)

    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("llm", [LIVE, LLMOptions()], ids=["live", "replay"])
def test_folder_that_was_there_stays(keep, tmp_path, llm):
    (tmp_path / "runs").mkdir()
    with pytest.raises(LQDError, match="overload"):
        during(keep(llm=llm), fail)

    assert not list((tmp_path / "runs").iterdir())


def test_recordings_may_answer_the_same_twice_at_once(keep):
    with keep(llm=LLMOptions()) as one, keep(llm=LLMOptions()) as other:
        assert one.path != other.path


def test_another_process_that_asks_the_same(keep):
    path = during(keep(), answer)
    folder = os.open(path, os.O_RDONLY)
    try:
        fcntl.flock(folder, fcntl.LOCK_EX)
        with pytest.raises(LQDError, match=r"^Expected to be the only one to ask this, but"):
            during(keep())
    finally:
        os.close(folder)


def test_place_that_cannot_be_written(keep, tmp_path):
    (tmp_path / "file").touch()

    with pytest.raises(LQDError, match=r"but that failed \(Not a dir.*another place with --out\.$"):
        during(keep(output=tmp_path / "file" / "one"))


def test_output_that_is_not_there(keep, tmp_path):
    with pytest.raises(LQDError, match=r"^Expected to move .*; move it there yourself\.$"):
        during(keep(), answer, lambda kept: kept.move_into(tmp_path / "nowhere"))

    assert len(list((tmp_path / "runs").glob(".inference-*/answer"))) == 1
