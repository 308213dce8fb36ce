import errno
import os
import re

import numpy as np
import pytest

from lqd_envs import SolutionSpace, atomic_file
from lqd_search import LanguageDrivenQD, Values, compete_by_coin
from lqd_search.evaluation.contact import CONTACT
from lqd_search.methods.by_name import repair_motions
from lqd_search.methods.genetic_algorithm import GeneticAlgorithm
from lqd_search.methods.map_elites_success import MapElitesSuccess
from lqd_search.methods.plus_switches import Switch, emitter_with
from lqd_search.methods.random_search import RandomSearch
from lqd_search.runs.checkpoint import (
    CheckpointError,
    NoCheckpointError,
    load_checkpoint,
    save_checkpoint,
)


def new_method(toy, **options):
    return LanguageDrivenQD(
        toy,
        descriptors=toy.descriptors,
        fitness_names=toy.fitness_names,
        evaluations=969,
        batch_size=32,
        rng=np.random.default_rng(0),
        passive_fields={"expert": ((), np.bool_)},
        minimum=16,
        cells=400,
        **options,
    )


def step(method, toy):
    solutions = method.ask()
    method.tell(toy.evaluate(solutions))
    return solutions.tobytes()


@pytest.mark.parametrize("coin", [False, True])
@pytest.mark.parametrize("generations", [0, 1, 2, 6, 7, 20])
def test_from_a_checkpoint_a_run_goes_on_bit_for_bit(toy, tmp_path, generations, coin):
    options = {"competition": compete_by_coin(np.random.default_rng(3))} if coin else {}
    method, path = new_method(toy, **options), tmp_path / "checkpoint"
    for _ in range(generations):
        step(method, toy)
    save_checkpoint(str(path), method, trusted=[type(toy)])
    twin = load_checkpoint(str(path), trusted=[type(toy)])
    while not method.done:
        assert step(method, toy) == step(twin, toy)
    assert twin.done
    assert twin.exploration == method.exploration
    assert twin.archive.specs == method.archive.specs
    for name, column in method.output().items():
        assert twin.output()[name].tobytes() == column.tobytes()
    assert list(tmp_path.iterdir()) == [path]


def evaluate(solutions):
    """Values for any motions, as if an object stood beside the centre."""
    distance = np.linalg.norm(solutions[:, :3] - 0.5, axis=1)
    valid = solutions[:, 2] > -0.5
    return Values(
        valid=valid,
        success=valid & (distance < 0.5),
        fitness={"near": np.where(valid, -distance, np.nan)},
        measures={
            "end.place": np.where(valid[:, None], solutions[:, :2], np.nan),
            "end.motion": np.where(valid[:, None], solutions[:, 6:9], np.nan),
        },
        perceived={CONTACT: np.where((distance < 0.9)[:, None], solutions[:, :6], np.nan)},
    )


SPACE = SolutionSpace()
OPTIONS = {"fitness": "near", "evaluations": 384, "batch_size": 32}
MAKERS = {
    "every switch": lambda rng: MapElitesSuccess(
        SPACE,
        descriptors={"end.place": 2, "end.motion": 3},
        rng=rng,
        relearn_at=96,
        emitter=emitter_with(tuple(Switch), space=SPACE),
        passive_fields={CONTACT: ((6,), np.float64)},
        minimum=16,
        **OPTIONS,
    ),
    "genetic": lambda rng: GeneticAlgorithm(
        SPACE, rng=rng, lower=SPACE.lower, upper=SPACE.upper, repair=repair_motions, **OPTIONS
    ),
    "random": lambda rng: RandomSearch(SPACE, rng=rng, **OPTIONS),
}


@pytest.mark.parametrize("make", MAKERS.values(), ids=MAKERS.keys())
def test_every_method_goes_on_bit_for_bit_from_each_generation(tmp_path, make):
    method, path, asked, told = make(np.random.default_rng(5)), tmp_path / "checkpoint", [], []
    while not method.done:
        save_checkpoint(path, method)
        asked.append(method.ask())
        told.append(evaluate(asked[-1]))
        method.tell(told[-1])
        twin = load_checkpoint(path)
        assert twin.ask().tobytes() == asked[-1].tobytes()
        twin.tell(told[-1])
        for name, column in method.output().items():
            assert twin.output()[name].tobytes() == column.tobytes()
    assert len(asked) == 12


def test_the_same_state_gives_the_same_bytes(toy, tmp_path):
    for name in ("one", "two"):
        method = new_method(toy)
        for _ in range(8):
            step(method, toy)
        save_checkpoint(tmp_path / name, method, trusted=[type(toy)])
    assert (tmp_path / "one").read_bytes() == (tmp_path / "two").read_bytes()


def test_a_checkpoint_replaces_the_last_one(tmp_path):
    path = tmp_path / "checkpoint"
    for state in ({"generation": 1, "log": list(range(1000))}, {"generation": 2}):
        save_checkpoint(path, state)
        assert load_checkpoint(path) == state


SENTENCE = re.compile(
    r"Expected a checkpoint in \S+checkpoint, but it cannot be read \([^\n]+\); restore the file, "
    r"or delete it to begin the run again from its start, which gives the same result with the "
    r"same seed\."
)


def refusal(path):
    """Load what must be refused, and return the one sentence that says why."""
    with pytest.raises(CheckpointError) as caught:
        load_checkpoint(path)
    assert SENTENCE.fullmatch(str(caught.value))
    return str(caught.value)


@pytest.fixture
def saved(tmp_path):
    path = tmp_path / "checkpoint"
    save_checkpoint(path, {"generation": 3, "solutions": np.arange(6.0)})
    return path


def test_every_truncation_is_found(saved):
    content = saved.read_bytes()
    for end in range(len(content)):
        saved.write_bytes(content[:end])
        refusal(saved)
    saved.write_bytes(content + b"\n")
    assert "bytes after its head instead of" in refusal(saved)


def test_every_flipped_byte_is_found(saved):
    content = saved.read_bytes()
    for i in range(len(content)):
        flip = (0x01, 0x08, 0xFF)[i % 3]
        saved.write_bytes(content[:i] + bytes([content[i] ^ flip]) + content[i + 1 :])
        with pytest.raises(CheckpointError, match=r"cannot be read|checkpoint format 2 in"):
            load_checkpoint(saved)


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        (b"lqd checkpoint", b"npz checkpoint", "it does not begin like one"),
        (b"format 2", b"format x", "its head is damaged"),
        (b"sha256 ", b"sha512 ", "its head is damaged"),
        (b"generation", b"generatiom", "its bytes are others than were written"),
    ],
)
def test_the_reason_is_given(saved, old, new, reason):
    saved.write_bytes(saved.read_bytes().replace(old, new, 1))
    assert f"({reason})" in refusal(saved)


def test_another_format_is_named(saved):
    saved.write_bytes(b"lqd checkpoint\nformat 3\nanything")
    with pytest.raises(
        CheckpointError, match=r"format 2 in \S+, got 3; delete it to begin the run"
    ):
        load_checkpoint(saved)


def test_a_missing_one_is_an_error_of_its_own(tmp_path):
    with pytest.raises(NoCheckpointError, match="but there is none; begin the run again from its"):
        load_checkpoint(tmp_path / "checkpoint")


def test_a_folder_in_its_place_is_refused(tmp_path):
    (tmp_path / "checkpoint").mkdir()
    assert "Is a directory" in refusal(tmp_path / "checkpoint")


def test_what_it_must_not_hold_is_named_when_it_is_written_and_read(toy, tmp_path):
    path = tmp_path / "checkpoint"
    with pytest.raises(CheckpointError, match=r"but it holds .*ToyProblem, which no"):
        save_checkpoint(path, [toy])
    assert not path.exists()
    save_checkpoint(path, [toy], trusted=[type(toy)])
    message = "it names .*ToyProblem, which no state may name; pass it to load_checkpoint as trus"
    with pytest.raises(CheckpointError, match=message):
        load_checkpoint(path)


def test_what_cannot_be_written_leaves_the_last_one(saved, monkeypatch):
    before = saved.read_bytes()

    def fail(_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(atomic_file.os, "fsync", fail)
    with pytest.raises(CheckpointError) as caught:
        save_checkpoint(saved, {"generation": 4})
    assert str(caught.value) == (
        f"Expected to write the checkpoint {saved}, but that failed (No space left on device); the "
        "last checkpoint is untouched: make space or make the folder writable, then go on with "
        f"`lqd run --resume {saved.parent}`."
    )
    assert saved.read_bytes() == before
    assert list(saved.parent.iterdir()) == [saved]
