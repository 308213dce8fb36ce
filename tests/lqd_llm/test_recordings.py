import json
from dataclasses import FrozenInstanceError

import pytest

from lqd_llm import COUNTS, KINDS, available_samples, load_recording
from lqd_llm.errors import RecordingError


def test_every_recording_loads(task, sample):
    recording = load_recording(task.name, sample=sample)

    assert (recording.task, recording.sample) == (task.name, sample)
    assert tuple(recording.exchanges) == KINDS
    counts = {kind: len(recording.exchanges[kind].reply.functions) for kind in KINDS}
    assert counts == COUNTS


def test_recordings_say_where_they_come_from(task, sample):
    recording = load_recording(task.name, sample=sample)

    assert recording.model == "claude (version not reported)"
    assert "outside the API" in recording.provenance
    assert "a conversation of its own" in recording.provenance


def test_five_samples_of_each_task_ship(task):
    assert available_samples(task.name) == (0, 1, 2, 3, 4)


def test_samples_are_found_by_their_file_names(tmp_path):
    names = ["mug-10.json", "mug-2.json", "mug-02.json", "my-mug-0.json", "mug-x.json", "mug-1.txt"]
    for name in names:
        (tmp_path / name).touch()

    assert available_samples("mug", directory=tmp_path) == (2, 10)
    assert available_samples("my-mug", directory=tmp_path) == (0,)
    assert available_samples("faucet", directory=tmp_path) == ()
    assert available_samples("faucet", directory=tmp_path / "none") == ()


def test_own_directory_is_read(recorded, write):
    recorded["model"] = "another"

    assert load_recording("faucet", sample=0, directory=write(recorded)).model == "another"


def test_recording_is_frozen():
    with pytest.raises(FrozenInstanceError):
        load_recording("faucet", sample=0).task = "drawer"


def test_missing_sample_names_the_available_ones():
    with pytest.raises(RecordingError) as caught:
        load_recording("faucet", sample=7)

    assert str(caught.value) == (
        "Found no recording of the task 'faucet' with sample 7; "
        "recorded samples of 'faucet': 0, 1, 2, 3, 4; ask for one of these."
    )


@pytest.mark.parametrize("name", ["kettle", "Faucet", "", "../recordings/faucet", "."])
def test_missing_task_names_the_recorded_ones(name):
    with pytest.raises(RecordingError) as caught:
        load_recording(name, sample=0)

    assert str(caught.value) == (
        f"Found no recording of the task {name!r} with sample 0; no sample of {name!r} is "
        "recorded, and the recorded tasks are drawer, faucet, grasp, push; "
        "ask for one of these or name another directory."
    )


def test_missing_directory_has_no_tasks(tmp_path):
    with pytest.raises(RecordingError, match="the recorded tasks are none"):
        load_recording("faucet", sample=0, directory=tmp_path / "none")


@pytest.mark.parametrize("content", [b"", b"{", b"faucet", b"\xff\xfe"])
def test_other_than_json_is_refused(tmp_path, content):
    (tmp_path / "faucet-0.json").write_bytes(content)

    message = (
        r"^The recording faucet-0\.json is not of the right form at the top level: "
        r"Invalid JSON: [^\n]+; restore the file\.$"
    )
    with pytest.raises(RecordingError, match=message):
        load_recording("faucet", sample=0, directory=tmp_path)


def test_a_folder_in_its_place_is_refused(tmp_path):
    (tmp_path / "faucet-0.json").mkdir()

    message = (
        r"^The recording faucet-0\.json cannot be read \(Is a directory\); restore the file\.$"
    )
    with pytest.raises(RecordingError, match=message):
        load_recording("faucet", sample=0, directory=tmp_path)


def no_model(content):
    del content["model"]


def extra_key(content):
    content["usage"] = 3


def sample_as_text(content):
    content["sample"] = "0"


def code_as_number(content):
    content["replies"]["fitness"]["reply"]["functions"][1]["code"] = 3


def no_reply(content):
    del content["replies"]["direct"]["reply"]


def no_kind(content):
    del content["replies"]["timestamps"]


def unknown_kind(content):
    content["replies"]["moments"] = content["replies"]["timestamps"]


def other_task(content):
    content["task"] = "drawer"


def other_sample(content):
    content["sample"] = 3


KINDS_TEXT = "at replies: expected the kinds success, fitness, timestamps, quantities, direct, got "


@pytest.mark.parametrize(
    ("change", "problem"),
    [
        (no_model, "at model: Field required"),
        (extra_key, "at usage: Extra inputs are not permitted"),
        (sample_as_text, "at sample: Input should be a valid integer"),
        (
            code_as_number,
            "at replies.fitness.reply.functions.1.code: Input should be a valid string",
        ),
        (no_reply, "at replies.direct.reply: Field required"),
        (no_kind, KINDS_TEXT + "success, fitness, quantities, direct"),
        (unknown_kind, KINDS_TEXT + "success, fitness, timestamps, quantities, direct, moments"),
        (other_task, "at task and sample: it holds sample 0 of the task 'drawer'"),
        (other_sample, "at task and sample: it holds sample 3 of the task 'faucet'"),
    ],
)
def test_other_forms_are_refused(recorded, write, change, problem):
    change(recorded)

    with pytest.raises(RecordingError) as caught:
        load_recording("faucet", sample=0, directory=write(recorded))

    assert str(caught.value) == (
        f"The recording faucet-0.json is not of the right form {problem}; restore the file."
    )


def test_only_the_first_of_many_problems_is_told(recorded, write):
    for key in ("task", "model", "system"):
        del recorded[key]

    with pytest.raises(RecordingError, match=r"^[^\n]*at task: Field required[^\n]*$") as caught:
        load_recording("faucet", sample=0, directory=write(recorded))
    assert "model" not in str(caught.value)


def test_changed_recording_round_trips(recorded, write):
    folder = write(json.loads(json.dumps(recorded)))

    assert load_recording("faucet", sample=0, directory=folder) == load_recording(
        "faucet", sample=0
    )
