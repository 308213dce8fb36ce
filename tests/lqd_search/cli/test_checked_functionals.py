"""Checking functionals that are there already; `lqd infer` tests those that are inferred."""

import re

import pytest

from lqd_envs import LQDError, get_task
from lqd_envs.tasks.examples import example_solutions
from lqd_llm import load_recording, prompt_hash
from lqd_llm.sandbox import SandboxError
from lqd_llm.sandbox.supervisor import Supervisor
from lqd_search.cli import checked_functionals
from lqd_search.cli.checked_functionals import check_functionals, infer_functionals
from lqd_search.cli.llm_options import LLMOptions
from lqd_search.runs.function_text import DIRECT_KINDS, FunctionText
from lqd_search.runs.functionals_folder import read_functionals, write_functionals

TASK = get_task("LQD/Drawer-v0")


@pytest.fixture(autouse=True)
def examples(monkeypatch):
    """Fewer example motions, to save time; it notes how often they are simulated."""
    simulated = []

    def few(task):
        simulated.append(task)
        return example_solutions(task)[62:70]

    monkeypatch.setattr(checked_functionals, "example_solutions", few)
    return simulated


@pytest.fixture(scope="module")
def inferred():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(
            checked_functionals, "example_solutions", lambda task: example_solutions(task)[62:70]
        )
        return infer_functionals(
            TASK,
            llm=LLMOptions(),
            instruction=TASK.instruction,
            sample=1,
            threads=1,
            allow_weak=False,
            transcript=None,
        )


def check(texts, *, allow_weak=False):
    return check_functionals(TASK, texts, threads=1, allow_weak=allow_weak)


def changed(texts, kind, code):
    """The functionals with another code for the first of a kind."""
    place = [text.kind for text in texts].index(kind)
    old = texts[place]
    new = FunctionText(kind, old.name, old.description, code)
    return (*texts[:place], new, *texts[place + 1 :])


def test_inferred_functionals(inferred):
    recorded = load_recording(TASK.name, sample=1)

    kinds = [text.kind for text in inferred.texts]
    assert kinds == [
        "success",
        *["fitness"] * 3,
        *["timestamp"] * 4,
        *["quantity"] * 4,
        *DIRECT_KINDS,
    ]
    assert {text.name for text in inferred.texts if text.kind == "quantity"} | {
        "direct.descriptor"
    } == set(inferred.lengths)
    assert inferred.lengths["gripper_position_and_drawer_opening"] == 4
    assert inferred.lengths["direct.descriptor"] == 5
    assert inferred.prompt_hashes == {
        kind: prompt_hash(recorded.system, exchange.prompt)
        for kind, exchange in recorded.exchanges.items()
    }
    assert (inferred.model, inferred.provenance) == (recorded.model, recorded.provenance)
    assert inferred.usage.unreported == 5


@pytest.mark.parametrize(
    ("instruction", "told"),
    [
        (" ", "Expected an instruction of at least one word, but it is empty; say it."),
        (
            "Open \udcff",
            "Expected an instruction in UTF-8, but its character 6 is '\\udcff'; type it anew.",
        ),
    ],
)
def test_instruction_that_cannot_be_asked(instruction, told):
    with pytest.raises(LQDError) as caught:
        infer_functionals(
            TASK,
            llm=LLMOptions(),
            instruction=instruction,
            sample=0,
            threads=1,
            allow_weak=False,
            transcript=None,
        )
    assert str(caught.value) == told


def test_a_folder_gives_what_was_inferred(inferred, tmp_path, examples):
    write_functionals(tmp_path, inferred.texts)
    checked = check(read_functionals(tmp_path))

    assert checked.texts == inferred.texts
    assert checked.lengths == inferred.lengths
    assert (checked.remarks, checked.dropped, checked.repaired) == ((), (), ())
    assert checked.usage is None
    assert "folder" in checked.provenance
    assert len(examples) == 1


@pytest.mark.parametrize(
    ("kinds", "missing"),
    [
        (("fitness", "timestamp", "quantity"), "success, and no direct.success, direct.fitness"),
        (("success", *DIRECT_KINDS[:2]), "fitness, timestamp, quantity, and no direct.descriptor;"),
        ((), "success, fitness, timestamp, quantity, and no direct.success, direct.fitness, dire"),
    ],
)
def test_too_few_functionals(inferred, kinds, missing, examples):
    with pytest.raises(LQDError) as caught:
        check([text for text in inferred.texts if text.kind in kinds])

    assert f"but there is no {missing}" in str(caught.value)
    assert examples == []


@pytest.mark.parametrize("direct", [True, False])
def test_either_kind_of_steering_is_enough(inferred, direct):
    texts = tuple(text for text in inferred.texts if (text.kind in DIRECT_KINDS) == direct)

    assert check(texts).texts == texts


def test_function_that_fails_is_named_with_its_file_and_line(inferred):
    texts = changed(inferred.texts, "fitness", "def fitness(info):\n    return info['no']\n")
    name = next(text.file_name for text in texts if text.kind == "fitness")

    with pytest.raises(LQDError) as caught:
        check(texts)
    assert re.fullmatch(
        rf"Expected functionals that pass their checks, but {re.escape(name)} fails \(KeyError in "
        r"line 3: raised on (\d) of \1 example motions\); correct the file, or leave it out\.",
        str(caught.value),
    )


def test_all_that_fail_are_named(inferred):
    texts = changed(inferred.texts, "success", "def success(infos):\n    return 1\n")
    texts = changed(texts, "direct.descriptor", "import os\n")

    with pytest.raises(LQDError) as caught:
        check(texts)
    told = str(caught.value)
    assert "but success.py fails (TypeError: returned a value of type int, not a bool, on " in told
    assert "and direct.descriptor.py fails (RejectedCodeError in line 2: " in told
    assert told.endswith("correct the files, or leave them out.")


def test_names_of_a_person_stay_as_they_are(inferred):
    constant = FunctionText("quantity", "MyNumbers", "", "def quantity(info):\n    return (1, 2)\n")
    checked = check((*inferred.texts, constant))

    assert checked.lengths["MyNumbers"] == 2
    assert checked.remarks[0].startswith("The quantity 'MyNumbers' gives the same numbers at the")


def test_only_recorded_code_may_run_in_a_weak_sandbox(inferred, monkeypatch):
    def check_locks(self, _told):
        if not self._allow_weak:
            raise SandboxError("Expected all layers of the sandbox, but this system lacks one.")

    monkeypatch.setattr(Supervisor, "_check_locks", check_locks)
    other = changed(inferred.texts, "fitness", "def fitness(info):\n    return 0.0\n")

    assert check(inferred.texts).texts == inferred.texts
    with pytest.raises(SandboxError, match="lacks one"):
        check(other)
    assert check(other, allow_weak=True).texts == other
