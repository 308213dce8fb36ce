"""A model's answer, and the reply that is read from it."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from pydantic import ValidationError

from lqd_llm.errors import ReplyError
from lqd_llm.form_problem import FormProblem
from lqd_llm.model_options import MOST_TOKENS
from lqd_llm.reply import Reply
from lqd_llm.request import Request
from lqd_llm.usage import Usage, answer_usage

_CUT = ("max_tokens", "model_context_window_exceeded")


@dataclass(frozen=True)
class Answer:
    """What came back for a request, exactly as it came.

    Attributes:
        body: The response of the API, read as JSON; its text where it is none.
        provenance: How the answer was taken; shown wherever results rest on it.
        request_id: What the API calls the request, if it said so.
        date: When the API answered, in its own words, if it said so.
    """

    body: object
    provenance: str
    request_id: str | None = None
    date: str | None = None

    @property
    def model(self) -> str:
        """The model that answered, as far as it is known."""
        model = self._fields.get("model")
        return model if isinstance(model, str) else "unknown"

    @property
    def stop_reason(self) -> str | None:
        """Why the reply ended; `"end_turn"` when it is complete."""
        reason = self._fields.get("stop_reason")
        return reason if isinstance(reason, str) else None

    @property
    def text(self) -> str | None:
        """What the model said, its thoughts aside; None when it said nothing."""
        content = self._fields.get("content")
        blocks = content if isinstance(content, list) else []
        texts = [
            text
            for block in blocks
            if isinstance(block, Mapping) and block.get("type") == "text"
            if isinstance(text := block.get("text"), str)
        ]
        return "".join(texts) if texts else None

    @property
    def usage(self) -> Usage:
        """Tokens and cost of this answer."""
        return answer_usage(self._fields.get("usage"), model=self.model)

    @property
    def refusal(self) -> str | None:
        """What the API says about a refusal, if anything."""
        details = self._fields.get("stop_details")
        if not isinstance(details, Mapping):
            return None
        said = [details.get("category"), details.get("explanation")]
        return ": ".join(part for part in said if isinstance(part, str)) or None

    @property
    def _fields(self) -> Mapping[str, Any]:
        return self.body if isinstance(self.body, Mapping) else {}


def read_reply(answer: Answer, *, request: Request) -> Reply:
    """Read the functions from an answer.

    Args:
        answer: The answer.
        request: What it answers; errors name its subject.

    Raises:
        ReplyError: The model refused, its reply was cut, or it is not of the right form.
    """
    _check_stop_reason(answer, request=request)
    if answer.text is None:
        raise ReplyError(f"{_the_reply(request)} holds no text; try again or ask another model.")
    try:
        return Reply.model_validate_json(answer.text)
    except ValidationError as error:
        first = FormProblem.first(error)
        if first.kind == "json_invalid":
            problem = f"is not JSON ({first.message.removeprefix('Invalid JSON: ')})"
        else:
            problem = f"is JSON of another form than was asked for, at {first}"
        raise ReplyError(
            f"{_the_reply(request)} {problem}; try again or ask another model."
        ) from error


def is_complete(answer: Answer, *, request: Request) -> bool:
    """Return whether a reply can be read from an answer."""
    try:
        read_reply(answer, request=request)
    except ReplyError:
        return False
    return True


def _check_stop_reason(answer: Answer, *, request: Request) -> None:
    reason = answer.stop_reason
    if reason == "end_turn":
        return
    if reason in _CUT:
        limit = request.options.max_tokens
        advice = "raise max_tokens or " if limit < MOST_TOKENS else ""
        raise ReplyError(
            f"{_the_reply(request)} was cut at the limit of {limit:,} tokens; {advice}lower the "
            "effort."
            if reason == "max_tokens"
            else f"{_the_reply(request)} was cut because the model can hold no more; ask a model "
            "with a larger context window."
        )
    if reason == "refusal":
        why = f" ({answer.refusal})" if answer.refusal else ""
        raise ReplyError(
            f"The model {answer.model} refused to answer the {request.subject} prompt{why}; word "
            "the instruction differently or ask another model."
        )
    if not isinstance(answer.body, Mapping):
        raise ReplyError(
            f"{_the_reply(request)} is not JSON, so it does not come from the Anthropic API; check "
            "ANTHROPIC_BASE_URL and any proxy, and try again."
        )
    raise ReplyError(
        f"{_the_reply(request)} did not come to its end (its stop_reason is {reason!r}, expected "
        "'end_turn'); try again or ask another model."
    )


def _the_reply(request: Request) -> str:
    return f"The reply to the {request.subject} prompt"
