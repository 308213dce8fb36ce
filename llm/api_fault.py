"""The faults of the Anthropic API in words: what happened, and what to do."""

from anthropic import (
    Anthropic,
    AnthropicError,
    APIConnectionError,
    APIError,
    APIStatusError,
    APITimeoutError,
)

from lqd_llm.request import Request

_GET_A_KEY = "set ANTHROPIC_API_KEY to a key from https://platform.claude.com"
_WITHOUT_A_KEY = (
    "take the recorded replies with `--llm replay`, which need none but are of the tasks' own "
    "instructions only"
)
_LONGEST_MESSAGE = 500


def missing_key() -> str:
    """Say that there is no key."""
    return (
        f"Expected a key for the Anthropic API, but found none; {_GET_A_KEY}, or {_WITHOUT_A_KEY}."
    )


def unusable_key(client: Anthropic) -> str | None:
    """Say that the key cannot be sent at all, such as one with a line break; None if it can be."""
    for key in _secrets(client):
        if not key.isascii() or not key.isprintable() or key != key.strip():
            return (
                "Expected a key for the Anthropic API in plain characters, but it holds a space, a "
                f"line break or others at its ends or within; {_GET_A_KEY}, exactly as it is shown "
                "there."
            )
    return None


def what_happened(error: AnthropicError, *, request: Request, client: Anthropic) -> str:
    """Say why a request has no answer, in one sentence that never holds the key.

    Args:
        error: What the SDK raised once its retries were used up.
        request: What was asked.
        client: The client that asked.
    """
    if isinstance(error, APIStatusError):
        sentence = _status(error, request=request)
    elif isinstance(error, APITimeoutError):
        sentence = (
            f"The Anthropic API did not answer the {request.subject} prompt within "
            f"{request.options.timeout:g} seconds{_tries(error)}; try again, or lower the effort."
        )
    elif isinstance(error, APIConnectionError):
        # Its cause may quote the headers, and with them the key, so only the kind of it is told.
        cause = f" ({type(error.__cause__).__name__})" if error.__cause__ else ""
        sentence = (
            f"The connection to {client.base_url.host} failed{cause}{_tries(error)}; check the "
            "network, any proxy and ANTHROPIC_BASE_URL, and try again."
        )
    else:
        said = " ".join(str(error).split()).rstrip(".")
        sentence = f"The Anthropic SDK failed with {type(error).__name__} ({said}); {_GET_A_KEY}."
    for key in _secrets(client):
        sentence = sentence.replace(key, "[key]")
    return sentence


def _status(error: APIStatusError, *, request: Request) -> str:
    status, said, subject = error.status_code, _said(error), request.subject
    sentences = {
        400: f"The Anthropic API does not accept the {subject} prompt{said}; change the option or "
        "the account setting that it names.",
        401: f"The Anthropic API does not accept the key{said}; {_GET_A_KEY}.",
        402: f"The Anthropic API asks for payment{said}; see to the account's credit.",
        403: f"The key may not use the model {request.options.model!r}{said}; ask another model or "
        "use another key.",
        404: f"The Anthropic API knows no model {request.options.model!r}{said}; name another.",
        413: f"The {subject} prompt is too large for the Anthropic API{said}; shorten the "
        "instruction.",
        429: f"The Anthropic API refused the {subject} prompt because of a rate limit"
        f"{_tries(error)}{said}; {_wait(error)}.",
        529: f"The Anthropic API is overloaded{_tries(error)}{said}; try again in some minutes.",
    }
    if status in sentences:
        return sentences[status]
    if status >= 500:
        return (
            f"The Anthropic API failed with status {status}{_tries(error)}{said}; try again in "
            "some minutes, and see https://status.claude.com."
        )
    return f"The Anthropic API answered the {subject} prompt with status {status}{said}; try again."


def _wait(error: APIStatusError) -> str:
    seconds = error.response.headers.get("retry-after", "")
    return f"try again in {seconds} seconds" if seconds.isdigit() else "try again in a minute"


def _tries(error: APIError) -> str:
    """Say how often it was tried, where it was tried more than once; the SDK says so in a header.

    That is not always as often as it may be: the API can say that another try is in vain.
    """
    retries = error.request.headers.get("x-stainless-retry-count", "")
    return f", {int(retries) + 1} times in a row" if retries.isdigit() and int(retries) else ""


def _said(error: APIStatusError) -> str:
    """Quote the API's own message on one line, so that the whole stays a sentence."""
    message = " ".join(str(error.api_message or "").split()).rstrip(".")
    if len(message) > _LONGEST_MESSAGE:
        message = f"{message[:_LONGEST_MESSAGE]}..."
    number = f"request {error.request_id}" if error.request_id else ""
    parts = ", ".join(part for part in (message and f"'{message}'", number) if part)
    return f" ({parts})" if parts else ""


def _secrets(client: Anthropic) -> tuple[str, ...]:
    return tuple(key for key in (client.api_key, client.auth_token) if key)
