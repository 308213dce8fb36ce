"""What can be chosen about the model that is asked."""

import math
from dataclasses import dataclass
from typing import Literal, TypeAlias, get_args

from lqd_llm.errors import ModelOptionsError

DEFAULT_MODEL = "claude-opus-5-5"
"""The model that is asked unless another is named."""

Effort: TypeAlias = Literal["low", "medium", "high", "xhigh", "max"]
"""How much effort a model can be told to put into its reply."""

MOST_TOKENS = 21_333
"""Most tokens that a model can be asked for: about as many as come within ten minutes. What takes
longer, the Anthropic SDK asks for in a stream only, since connections that are silent get lost."""

EFFORTS: tuple[Effort, ...] = get_args(Effort)
"""All efforts, from the least to the most."""


@dataclass(frozen=True)
class ModelOptions:
    """Which model is asked, and how.

    Model and effort decide what is answered, so they are part of a request's key. The others only
    limit what is waited for and paid, and may change between two tries of the same inference.

    Attributes:
        model: Name of the model, as the Anthropic API knows it.
        effort: One of `EFFORTS`, or None for the model's own default. Not every model takes every
            effort.
        max_tokens: Most tokens of a reply, those spent on thinking included; a model is asked for
            at most `MOST_TOKENS`. The default is several times what replies take.
        timeout: Longest wait for a reply, in seconds; each retry waits as long again.
        max_retries: How often a request is sent again after a rate limit, an overload, a fault of
            the server, a dropped connection or a time-out. The waits between them are those that
            the API asks for, and grow from half a second to eight where it asks for none.

    Raises:
        ModelOptionsError: A value is out of range.
    """

    model: str = DEFAULT_MODEL
    effort: Effort | None = None
    max_tokens: int = 20_000
    timeout: float = 600.0
    max_retries: int = 4

    def __post_init__(self) -> None:
        if not self.model.strip():
            raise _unexpected(
                "the name of a model", self.model, f"pass one such as {DEFAULT_MODEL}"
            )
        if self.effort is not None and self.effort not in EFFORTS:
            known = f"pass one of {', '.join(EFFORTS)}, or none for the model's own default"
            raise _unexpected("an effort", self.effort, known)
        if self.max_tokens < 1:
            raise _unexpected("max_tokens of at least 1", self.max_tokens, "raise it")
        if not 0 < self.timeout < math.inf:
            raise _unexpected("a finite timeout of more than 0 seconds", self.timeout, "change it")
        if self.max_retries < 0:
            raise _unexpected("max_retries of at least 0", self.max_retries, "pass 0 for no retry")


def _unexpected(expected: str, value: object, advice: str) -> ModelOptionsError:
    return ModelOptionsError(f"Expected {expected}, but got {value!r}; {advice}.")
