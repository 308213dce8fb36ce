"""A request to a model, and the key under which its answer is kept."""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib import resources
from typing import Any, Literal

from lqd_llm.model_options import ModelOptions


@dataclass(frozen=True)
class Turn:
    """One turn of a conversation.

    Attributes:
        role: `"user"` or `"assistant"`.
        text: What is said.
    """

    role: Literal["user", "assistant"]
    text: str


def reply_schema() -> Mapping[str, Any]:
    """Return the JSON schema that every reply must follow; `lqd_llm.Reply` validates the same."""
    return _reply_schema()


@dataclass(frozen=True)
class Request:
    """Everything that is asked of a model at once.

    Attributes:
        subject: What is asked for, in a word or two, such as `"fitness"`; for people only.
        options: Which model is asked, and how.
        system: The system prompt.
        messages: The conversation, which ends with a user's turn.
        sample: Which of several answers to the same prompts is wanted.
        attempt: 0 for a first answer; from 1 on, which repair of a function it is.
        schema: JSON schema of the reply.
    """

    subject: str
    options: ModelOptions
    system: str
    messages: tuple[Turn, ...]
    sample: int = 0
    attempt: int = 0
    schema: Mapping[str, Any] = field(default_factory=reply_schema, hash=False)

    @property
    def key(self) -> str:
        """SHA-256, in hex, of all that decides the answer.

        That is model, system prompt, messages, schema, sample and attempt, and the effort where
        one is chosen. Limits such as `max_tokens` are no part of it, so that a reply that was cut
        can be asked for again while all others are kept.
        """
        content: dict[str, Any] = {
            "model": self.options.model,
            "system": self.system,
            "messages": [{"role": turn.role, "content": turn.text} for turn in self.messages],
            "schema": self.schema,
            "sample": self.sample,
            "attempt": self.attempt,
        }
        if self.options.effort is not None:
            content["effort"] = self.options.effort
        text = json.dumps(content, sort_keys=True, separators=(",", ":"))
        return hashlib.sha256(text.encode()).hexdigest()


@cache
def _reply_schema() -> dict[str, Any]:
    file = resources.files("lqd_llm").joinpath("prompts", "reply.schema.json")
    schema: dict[str, Any] = json.loads(file.read_text("utf-8"))
    return schema
