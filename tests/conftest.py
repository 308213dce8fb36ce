"""A server on loopback that stands in for the Anthropic API, and what it answers."""

import json
import os
import socket
import threading
import time
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

MODEL = "claude-opus-5-5"
USAGE = {"input_tokens": 100, "output_tokens": 20, "cache_creation_input_tokens": 0}


def message(text: str, *, stop_reason: str = "end_turn", **changes: Any) -> dict[str, Any]:
    """What the API answers when the model says `text`."""
    return {
        "id": "msg_1",
        "type": "message",
        "role": "assistant",
        "model": MODEL,
        "content": [{"type": "thinking", "thinking": "{", "signature": ""}, text_block(text)],
        "stop_reason": stop_reason,
        "stop_sequence": None,
        "usage": USAGE,
        **changes,
    }


def text_block(text: str) -> dict[str, Any]:
    return {"type": "text", "text": text}


def reply_text(*functions: tuple[str, str]) -> str:
    """A reply of functions, each given by name and code."""
    entries = [
        {"name": name, "description": f"what {name} does", "code": code} for name, code in functions
    ]
    return json.dumps({"functions": entries})


def recorded_reply(prompt: str, *, sample: int = 0) -> str:
    """The recorded reply to a prompt of the faucet."""
    # Not everybody who tests has the extra `llm`.
    from lqd_llm import load_recording

    for exchange in load_recording("faucet", sample=sample).exchanges.values():
        if prompt == exchange.prompt:
            return exchange.reply.model_dump_json()
    raise AssertionError(f"nobody recorded this prompt: {prompt}")


class Words:
    """The functions above, for tests to take."""

    message = staticmethod(message)
    text_block = staticmethod(text_block)
    reply_text = staticmethod(reply_text)
    recorded_reply = staticmethod(recorded_reply)


@pytest.fixture
def words() -> type[Words]:
    return Words


@pytest.fixture
def no_network(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: Any) -> None:
        raise AssertionError("a connection was opened")

    monkeypatch.setattr(socket.socket, "connect", refuse)
    monkeypatch.setattr(socket.socket, "connect_ex", refuse)
    monkeypatch.setattr(socket, "getaddrinfo", refuse)


@dataclass(frozen=True)
class Response:
    """What the fake API does with a request.

    Attributes:
        body: What it sends: an object as JSON, bytes as they are.
        status: Status of the response.
        headers: Further headers.
        fault: `"silent"`: it sends nothing until the test is over; `"dropped"`: it hangs up;
            `"torn"`: it hangs up in the middle of the body.
    """

    body: Any = b""
    status: int = 200
    headers: dict[str, str] = field(default_factory=dict)
    fault: str = ""


class FakeApi:
    """A server on loopback that stands in for the Anthropic API and follows a test's script.

    Attributes:
        bodies: The bodies of all requests, in order.
        headers: Their headers.
        script: Responses to the next requests; once it is empty, `answer` makes them.
        answer: Makes the response of the body of a request.
        arrived: Released once for each request.
    """

    response = Response

    def __init__(self) -> None:
        self.bodies: list[dict[str, Any]] = []
        self.headers: list[dict[str, str]] = []
        self.script: deque[Response] = deque()
        self.answer: Callable[[dict[str, Any]], Response] = lambda body: Response(
            message(recorded_reply(body["messages"][0]["content"]))
        )
        self.arrived = threading.Semaphore(0)
        self.over = threading.Event()
        self._server = ThreadingHTTPServer(("127.0.0.1", 0), self._handler())
        self._thread = threading.Thread(target=self._server.serve_forever, args=(0.01,))
        self._thread.start()
        self.url = f"http://127.0.0.1:{self._server.server_port}"

    def close(self) -> None:
        self.over.set()
        self._server.shutdown()
        self._thread.join()
        self._server.server_close()

    def _handler(self) -> type[BaseHTTPRequestHandler]:
        api = self

        class Handler(BaseHTTPRequestHandler):
            def do_POST(self) -> None:
                length = int(self.headers["content-length"])
                body = json.loads(self.rfile.read(length))
                api.bodies.append(body)
                api.headers.append({name.lower(): value for name, value in self.headers.items()})
                response = api.script.popleft() if api.script else api.answer(body)
                api.arrived.release()
                self._send(response)

            def _send(self, response: Response) -> None:
                self.close_connection = True
                if response.fault == "silent":
                    api.over.wait()
                if response.fault in ("silent", "dropped"):
                    return
                raw = response.body
                content = raw if isinstance(raw, bytes) else json.dumps(raw).encode()
                length = len(content) + (1000 if response.fault == "torn" else 0)
                self.send_response(response.status)
                fixed = {"content-type": "application/json", "request-id": "req_1"}
                for name, value in {**fixed, **response.headers}.items():
                    self.send_header(name, value)
                self.send_header("content-length", str(length))
                self.end_headers()
                self.wfile.write(content)

            def log_message(self, format: str, *args: Any) -> None:  # noqa: A002
                """Say nothing."""

        return Handler


@pytest.fixture
def api() -> Iterator[FakeApi]:
    server = FakeApi()
    yield server
    server.close()


@pytest.fixture
def no_credentials(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Whatever key this machine has, the SDK finds none."""
    for name in [name for name in os.environ if name.startswith("ANTHROPIC_")]:
        monkeypatch.delenv(name)
    for name in ("HOME", "XDG_CONFIG_HOME"):
        monkeypatch.setenv(name, str(tmp_path / "no-home"))
    monkeypatch.setenv("NO_PROXY", "127.0.0.1")


@pytest.fixture
def sleeps(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """How long the SDK would have slept between its tries."""
    import anthropic._base_client

    slept: list[float] = []
    clock = SimpleNamespace(**{**vars(time), "sleep": slept.append})
    monkeypatch.setattr(anthropic._base_client, "time", clock)
    return slept
