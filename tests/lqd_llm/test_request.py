import hashlib
import json

import pytest

from lqd_llm import Reply
from lqd_llm.model_options import ModelOptions
from lqd_llm.request import Turn, reply_schema


def test_key_is_the_hash_of_what_the_recording_is_found_by(ask):
    request = ask("Write", sample=3, attempt=2)
    content = {
        "attempt": 2,
        "messages": [{"content": "Write", "role": "user"}],
        "model": "claude-opus-5-5",
        "sample": 3,
        "schema": reply_schema(),
        "system": "Be brief.",
    }
    canonical = json.dumps(content, sort_keys=True, separators=(",", ":")).encode()

    assert request.key == hashlib.sha256(canonical).hexdigest()


@pytest.mark.parametrize(
    "changes",
    [
        {"options": ModelOptions(model="claude-sonnet-5-5")},
        {"options": ModelOptions(effort="high")},
        {"system": "Be long."},
        {"messages": (Turn("user", "Write "),)},
        {"messages": (Turn("assistant", "Write"),)},
        {"schema": {"type": "object"}},
        {"sample": 1},
        {"attempt": 1},
    ],
)
def test_whatever_decides_the_answer_changes_the_key(ask, changes):
    assert ask(**changes).key != ask().key


@pytest.mark.parametrize(
    "changes",
    [
        {"options": ModelOptions(max_tokens=1, timeout=1.0, max_retries=0)},
        {"subject": "anything"},
        {"schema": dict(reversed(reply_schema().items()))},
    ],
)
def test_limits_labels_and_order_do_not_change_the_key(ask, changes):
    assert ask(**changes).key == ask().key


def test_schema_allows_no_further_properties():
    schema = reply_schema()

    assert schema["additionalProperties"] is False
    assert schema["properties"]["functions"]["items"]["additionalProperties"] is False
    assert set(schema["properties"]) == set(Reply.model_fields)
