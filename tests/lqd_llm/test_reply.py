import json
import keyword
import re
from importlib import resources

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from pydantic import ValidationError

from lqd_llm import FunctionSource, Reply

PROMPT_SCHEMA = json.loads(
    resources.files("lqd_llm").joinpath("prompts", "reply.schema.json").read_text("utf-8")
)


def source(name: str) -> FunctionSource:
    return FunctionSource(name=name, description="", code="")


def reply(*names: str) -> Reply:
    functions = [{"name": name, "description": "", "code": ""} for name in names]
    return Reply.model_validate_json(json.dumps({"functions": functions}))


def substance(schema: dict, definitions: dict) -> dict:
    """Follow references, and leave out titles and texts that concern people only."""
    if "$ref" in schema:
        return substance(definitions[schema["$ref"].rpartition("/")[2]], definitions)
    kept = {key: schema[key] for key in ("type", "additionalProperties") if key in schema}
    if "description" in schema and schema["type"] == "string":
        kept["description"] = schema["description"]
    if "items" in schema:
        kept["items"] = substance(schema["items"], definitions)
    if "properties" in schema:
        kept["required"] = sorted(schema["required"])
        kept["properties"] = {
            key: substance(value, definitions) for key, value in schema["properties"].items()
        }
    return kept


def test_models_say_what_the_schema_says():
    ours = Reply.model_json_schema()

    assert substance(ours, ours["$defs"]) == substance(PROMPT_SCHEMA, {})


@pytest.mark.parametrize(
    "content",
    [
        {},
        {"functions": [], "note": ""},
        {"functions": [{"name": "a", "description": ""}]},
        {"functions": [{"name": "a", "description": "", "code": "", "entry": ""}]},
        {"functions": [{"name": "a", "description": "", "code": None}]},
        {"functions": {"name": "a", "description": "", "code": ""}},
    ],
)
def test_other_forms_are_refused(content):
    with pytest.raises(ValidationError):
        Reply.model_validate_json(json.dumps(content))


def test_models_are_frozen():
    with pytest.raises(ValidationError, match="frozen"):
        source("a").name = "b"
    with pytest.raises(ValidationError, match="frozen"):
        reply("a").functions = ()


@pytest.mark.parametrize(
    ("sent", "kept"),
    [
        ("first_hot_tap_contact", "first_hot_tap_contact"),
        ("First Contact", "first_contact"),
        ("grip-depth (in m)", "grip_depth_in_m"),
        ("slid_5cm", "slid_5cm"),
        ("5cm slid", "_5cm_slid"),
        ("../../etc/passwd", "etc_passwd"),
        ("lambda", "lambda_"),
        ("höhe", "h_he"),
        ("", "function"),
        ("!?", "function"),
        ("a" * 300, "a" * 60),
    ],
)
def test_name_is_made_an_identifier(sent, kept):
    assert source(sent).name == kept


@given(st.text())
@example("İ")
@example("a" * 59 + "_b")
def test_every_name_becomes_a_lower_case_identifier(name):
    kept = source(name).name

    assert re.fullmatch("[a-z_][a-z0-9_]{0,60}", kept)
    assert not keyword.iskeyword(kept)
    assert source(kept).name == kept


@pytest.mark.parametrize(
    ("sent", "kept"),
    [
        (["a", "b"], ["a", "b"]),
        (["a", "a", "a"], ["a", "a_2", "a_3"]),
        (["a", "A", "a!"], ["a", "a_2", "a_3"]),
        (["a_2", "a", "a"], ["a_2", "a", "a_3"]),
        (["a", "a", "a_2"], ["a", "a_2", "a_2_2"]),
    ],
)
def test_repeated_name_gets_a_number(sent, kept):
    assert [function.name for function in reply(*sent).functions] == kept


@given(st.lists(st.sampled_from(["a", "A", "a_2", "a_2_2", "!", "function"]), max_size=8))
def test_names_are_distinct_and_stay_when_read_again(names):
    once = [function.name for function in reply(*names).functions]

    assert len(set(once)) == len(names)
    assert [function.name for function in reply(*once).functions] == once


def test_code_and_description_stay_as_they_came():
    text = '  first\n\tsecond "é"\r\n'
    function = FunctionSource(name="a", description=text, code=text)

    assert (function.description, function.code) == (text, text)
    assert Reply(functions=(function,)).functions[0] == function
