"""The four tasks in words, small motions made by hand, and models that tests give the words."""

import json
import math
import os
import socket
import threading
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from importlib import resources
from pathlib import Path
from typing import Any

import pytest

from lqd_envs.perception import Info, Infos, ObjectJoint, PerceptionSchema
from lqd_llm.answer import Answer
from lqd_llm.model_options import ModelOptions
from lqd_llm.prompts import KINDS, render_prompt
from lqd_llm.recordings import load_recording
from lqd_llm.request import Request, Turn

MOMENTS = 76


@dataclass(frozen=True)
class Task:
    name: str
    instruction: str
    schema: PerceptionSchema


MUG = PerceptionSchema(base="mug, the middle of its bottom", fixed=False, links=("mug",))
TASKS = (
    Task("grasp", "Grasp the mug", MUG),
    Task(
        "faucet",
        "Turn on the hot water",
        PerceptionSchema(
            base="faucet, where it stands on the table",
            fixed=True,
            links=("base", "hot_tap", "cold_tap"),
            joints=(
                ObjectJoint("hot_tap", "rad", 2 * math.pi / 3),
                ObjectJoint("cold_tap", "rad", 2 * math.pi / 3),
            ),
        ),
    ),
    Task(
        "drawer",
        "Open the drawer at least 10cm",
        PerceptionSchema(
            base="chest of drawers, the middle of its bottom",
            fixed=True,
            links=("body", "drawer"),
            joints=(ObjectJoint("drawer", "m", 0.20),),
        ),
    ),
    Task("push", "Slide the mug on the table at least 5cm", MUG),
)
FAUCET = TASKS[1]


@pytest.fixture(params=TASKS, ids=[task.name for task in TASKS])
def task(request: pytest.FixtureRequest) -> Task:
    return request.param


@pytest.fixture
def faucet() -> Task:
    return FAUCET


@pytest.fixture(params=range(5), ids=lambda sample: f"sample{sample}")
def sample(request: pytest.FixtureRequest) -> int:
    return request.param


@pytest.fixture
def no_contact(task: Task) -> Infos:
    """The gripper passes over the object, which stays as it is."""
    return [
        _info(task, gripper=(0.5, 0.001 * k, 0.3), touched=(), opened=0.0) for k in range(MOMENTS)
    ]


@pytest.fixture
def contact(task: Task) -> Infos:
    """The gripper touches the part that matters and takes it along until the motion's last hold."""
    part = {"grasp": "mug", "push": "mug", "faucet": "hot_tap", "drawer": "drawer"}[task.name]
    infos = []
    for k in range(MOMENTS):
        way = min(max(k - 20, 0), 40) / 40
        moved = {"grasp": (0.0, 0.0, 0.1 * way), "push": (0.1 * way, 0.0, 0.0)}
        dx, dy, dz = moved.get(task.name, (-0.15 * way, 0.0, 0.0))
        infos.append(
            _info(
                task,
                gripper=(0.5 + dx, dy, 0.06 + dz),
                touched=(part,) if k >= 10 else (),
                opened=way,
                mug=(0.5 + dx, dy, dz) if task.name in moved else None,
            )
        )
    return infos


def _info(
    task: Task,
    *,
    gripper: tuple[float, float, float],
    touched: tuple[str, ...],
    opened: float,
    mug: tuple[float, float, float] | None = None,
) -> Info:
    position = mug or (0.5, 0.0, 0.0)
    joints = task.schema.joints
    return Info(
        object_position=position,
        object_orientation=(0.0, 0.0, 0.0),
        object_table_contact=position[2] == 0.0,
        robot_table_contact=False,
        gripper_position=gripper,
        gripper_orientation=(0.1, -0.2, 0.3),
        gripper_contacts={link: link in touched for link in task.schema.links},
        # Only the first joint is the one that the instruction names.
        joint_positions={
            joint.name: joint.upper * opened * (joint is joints[0]) for joint in joints
        },
    )


@pytest.fixture
def recorded() -> dict[str, Any]:
    """The content of one recording that ships, to be changed."""
    file = resources.files("lqd_llm").joinpath("recordings", "faucet-0.json")
    return json.loads(file.read_text("utf-8"))


@pytest.fixture
def write(tmp_path: Path) -> Callable[[dict[str, Any]], Path]:
    """A function that writes a recording as sample 0 of the faucet and returns its folder."""

    def write_recording(content: dict[str, Any]) -> Path:
        (tmp_path / "faucet-0.json").write_text(json.dumps(content))
        return tmp_path

    return write_recording


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
    recording = load_recording("faucet", sample=sample)
    for kind in KINDS:
        if prompt == render_prompt(kind, instruction=FAUCET.instruction):
            return recording.exchanges[kind].reply.model_dump_json()
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
def ask() -> Callable[..., Request]:
    """A function that makes a request."""

    def request(prompt: str = "Write", **changes: Any) -> Request:
        turns = (Turn("user", prompt),)
        given = {"subject": "fitness", "options": ModelOptions(), "system": "Be brief."}
        return Request(**{**given, "messages": turns, **changes})

    return request


class ScriptedProvider:
    """Answers what a function makes of each request, and keeps the requests."""

    def __init__(self, make_text: Callable[[Request], str | dict[str, Any]]) -> None:
        self._make_text = make_text
        self.requests: list[Request] = []

    def ask(self, request: Request) -> Answer:
        self.requests.append(request)
        made = self._make_text(request)
        return Answer(made if isinstance(made, dict) else message(made), provenance="A script.")


@pytest.fixture
def scripted() -> type[ScriptedProvider]:
    return ScriptedProvider


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
