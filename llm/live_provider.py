"""Asking a model through the Anthropic API. Nothing else in this package uses the network."""

import json
from types import TracebackType
from typing import Self

from anthropic import Anthropic, AnthropicError, DefaultHttpxClient
from anthropic.types import (
    AssistantMessageParam,
    MessageParam,
    OutputConfigParam,
    TextBlockParam,
    UserMessageParam,
)

from lqd_llm.answer import Answer
from lqd_llm.api_fault import missing_key, unusable_key, what_happened
from lqd_llm.errors import ProviderError
from lqd_llm.model_options import MOST_TOKENS
from lqd_llm.request import Request

_PROVENANCE = (
    "Replies of a Claude model through the Anthropic API. Each prompt was asked in a conversation "
    "of its own."
)


class LiveProvider:
    """Asks a Claude model through the Anthropic API.

    Keep it in a `with` block, or close it, so that its connections are closed.

    Args:
        client: The client to ask through, which then is closed with the provider. By default one
            that finds its key as the Anthropic SDK does, first in `ANTHROPIC_API_KEY`.

    Raises:
        ProviderError: The SDK cannot load the credentials that its settings name, or the connection
            cannot be set up.
    """

    def __init__(self, client: Anthropic | None = None) -> None:
        self._client = _default_client() if client is None else client

    def ask(self, request: Request) -> Answer:
        """Ask the model, and ask again after faults that pass, as the request's options say.

        Raises:
            ProviderError: There is no answer, or more tokens are asked for than one can bring. The
                message says what happened and what to do, and never holds the key.
        """
        problem = unusable_key(self._client) or _too_long(request)
        if problem is None:
            try:
                return self._ask(request)
            except AnthropicError as error:
                problem = what_happened(error, request=request, client=self._client)
            except TypeError:
                if not _has_no_key(self._client):
                    raise
                problem = missing_key()
        # Only here, since the errors of the SDK hold the request with its headers, and an error
        # that is raised while another is handled hands that one on.
        raise ProviderError(problem)

    def close(self) -> None:
        """Close the connections."""
        self._client.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.close()

    def _ask(self, request: Request) -> Answer:
        options = request.options
        client = self._client.with_options(timeout=options.timeout, max_retries=options.max_retries)
        response = client.messages.with_raw_response.create(
            model=options.model,
            max_tokens=options.max_tokens,
            system=_system(request),
            messages=_messages(request),
            output_config=_output_config(request),
        )
        return Answer(
            body=_parsed(response.text()),
            provenance=_PROVENANCE,
            request_id=response.headers.get("request-id"),
            date=response.headers.get("date"),
        )


def _default_client() -> Anthropic:
    try:
        # As the SDK makes its own, which complains on its own where that fails.
        connections = DefaultHttpxClient()
    except (OSError, ValueError) as error:
        # A proxy may be named with its password, so only the kind of the error is told.
        why = error.strerror if isinstance(error, OSError) else None
        problem = (
            "The connection to the Anthropic API cannot be set up "
            f"({why or type(error).__name__}); check SSL_CERT_FILE, SSL_CERT_DIR and any proxy."
        )
    else:
        try:
            return Anthropic(http_client=connections)
        except AnthropicError as error:
            connections.close()
            problem = (
                f"The credentials for the Anthropic API cannot be loaded ({type(error).__name__}); "
                "set ANTHROPIC_API_KEY to a key from https://platform.claude.com."
            )
    raise ProviderError(problem)


def _too_long(request: Request) -> str | None:
    asked = request.options.max_tokens
    if asked <= MOST_TOKENS:
        return None
    return (
        f"Expected max_tokens of at most {MOST_TOKENS:,}, about what comes within ten minutes, but "
        f"got {asked:,}; lower it, and the effort where replies are cut."
    )


def _has_no_key(client: Anthropic) -> bool:
    return client.api_key is None and client.auth_token is None and client.credentials is None


def _system(request: Request) -> list[TextBlockParam]:
    # All prompts of a task share it, so from the second one on it comes from a cache.
    return [{"type": "text", "text": request.system, "cache_control": {"type": "ephemeral"}}]


def _messages(request: Request) -> list[MessageParam]:
    return [
        UserMessageParam(role=turn.role, content=turn.text)
        if turn.role == "user"
        else AssistantMessageParam(role=turn.role, content=turn.text)
        for turn in request.messages
    ]


def _output_config(request: Request) -> OutputConfigParam:
    config: OutputConfigParam = {
        "format": {"type": "json_schema", "schema": dict(request.schema)},
    }
    if request.options.effort is not None:
        config["effort"] = request.options.effort
    return config


def _parsed(text: str) -> object:
    try:
        parsed: object = json.loads(text)
    except (ValueError, RecursionError):
        return text
    return parsed
