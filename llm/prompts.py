"""The prompts in which a language model is asked for functionals."""

import hashlib
import re
from collections.abc import Mapping
from importlib import resources

from lqd_envs.perception import PerceptionSchema
from lqd_llm.errors import PromptError

KINDS = ("success", "fitness", "timestamps", "quantities", "direct")
"""The kinds of inference, one prompt each; `direct` is the ablation that asks for all at once."""

COUNTS = {"success": 1, "fitness": 3, "timestamps": 4, "quantities": 4, "direct": 3}
"""How many functions each kind asks for."""

_PLACEHOLDER = re.compile(r"\{([A-Z]+)\}")


def render_system(schema: PerceptionSchema) -> str:
    """Return the system prompt of one task, the same for every kind.

    Args:
        schema: The task's perception schema; its text tells the model what it may read.
    """
    return fill_template("system", {"PERCEPTION": schema.text()})


def render_prompt(kind: str, *, instruction: str) -> str:
    """Return the prompt that asks for one kind of functional.

    Args:
        kind: One of `KINDS`.
        instruction: The task in one sentence; it is put in literally, braces included.

    Raises:
        PromptError: `kind` is not one of `KINDS`.
    """
    if kind not in KINDS:
        raise PromptError(
            f"Expected a kind of prompt, got {kind!r}; pass one of {', '.join(KINDS)}."
        )
    return fill_template(kind, {"INSTRUCTION": instruction, "COUNT": str(COUNTS[kind])})


def prompt_hash(system: str, prompt: str) -> str:
    """Return the SHA-256, in hex, of a system prompt, a NUL character and a prompt, in UTF-8."""
    return hashlib.sha256(f"{system}\0{prompt}".encode()).hexdigest()


def fill_template(name: str, values: Mapping[str, str]) -> str:
    """Return one of the texts in `prompts/` with its placeholders filled.

    Args:
        name: Name of the file, without `.md`.
        values: What to put in place of `{KEY}`, by key; what is not named stays as it is.
    """
    template = resources.files("lqd_llm").joinpath("prompts", f"{name}.md").read_text("utf-8")
    # One pass: a placeholder inside a value must reach the model as it is.
    return _PLACEHOLDER.sub(lambda match: values.get(match[1], match[0]), template.strip())
