import hashlib

import pytest

from lqd_llm import COUNTS, KINDS, load_recording, prompt_hash, render_prompt, render_system
from lqd_llm.errors import PromptError
from lqd_llm.prompts import fill_template


def test_recorded_prompts_are_the_rendered_ones(task, sample):
    recording = load_recording(task.name, sample=sample)

    assert recording.system == render_system(task.schema)
    for kind in KINDS:
        rendered = render_prompt(kind, instruction=task.instruction)
        assert recording.exchanges[kind].prompt == rendered


@pytest.mark.parametrize("kind", ["fitness", "timestamps", "quantities"])
def test_prompt_asks_for_the_count(kind):
    assert f"Reply with {COUNTS[kind]} entries." in render_prompt(kind, instruction="Wave")


@pytest.mark.parametrize("instruction", ["Put {COUNT} mugs {away}", "{INSTRUCTION}", r"a\1\g<0>"])
def test_instruction_is_put_in_literally(instruction):
    first = render_prompt("fitness", instruction=instruction).splitlines()[0]

    assert first == f'The task is: "{instruction}"'


def test_no_placeholder_is_left(task):
    texts = [render_prompt(kind, instruction=task.instruction) for kind in KINDS]

    assert not any("{" in text for text in [render_system(task.schema), *texts])


@pytest.mark.parametrize("kind", ["system", "descriptor", "../prompts/fitness", ""])
def test_unknown_kind_names_the_known_ones(kind):
    with pytest.raises(PromptError) as caught:
        render_prompt(kind, instruction="Wave")

    assert str(caught.value) == (
        f"Expected a kind of prompt, got {kind!r}; "
        "pass one of success, fitness, timestamps, quantities, direct."
    )


def test_prompt_hash_is_sha256_of_both_parts():
    assert prompt_hash("ab", "c") == hashlib.sha256(b"ab\0c").hexdigest()
    assert prompt_hash("ab", "c") != prompt_hash("a", "bc")


def test_values_of_a_template_are_put_in_literally():
    values = {"NAME": "{CODE} {DESCRIPTION}", "CODE": r"\1 {NAME}"}
    lines = fill_template("repair", values).splitlines()

    assert '"{CODE} {DESCRIPTION}"' in lines[2]
    assert r"\1 {NAME}" in lines
    assert lines[0] == "{PROMPT}"
