"""The four tasks in words, small motions made by hand, and models that tests give the words."""

import json
import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lqd_envs.perception import Columns, Info, Infos, ObjectJoint, PerceptionSchema
from lqd_llm.answer import Answer
from lqd_llm.model_options import ModelOptions
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

    def __init__(
        self,
        make_text: Callable[[Request], str | dict[str, Any]],
        *,
        message: Callable[[str], dict[str, Any]],
    ) -> None:
        self._make_text = make_text
        self._message = message
        self.requests: list[Request] = []

    def ask(self, request: Request) -> Answer:
        self.requests.append(request)
        made = self._make_text(request)
        body = made if isinstance(made, dict) else self._message(made)
        return Answer(body, provenance="A script.")


@pytest.fixture
def scripted(words: Any) -> Callable[..., ScriptedProvider]:
    """A function that makes a `ScriptedProvider`."""
    return partial(ScriptedProvider, message=words.message)


def columns_of(task: Task, motions: list[Infos]) -> Columns:
    """The columns of motions that are given as infos."""
    names = {
        "gripper_contacts": task.schema.links,
        "joint_positions": [joint.name for joint in task.schema.joints],
    }
    columns = {}
    for key in Info.__annotations__:
        shape = (len(motions), MOMENTS, -1) if key in names else None
        rows = [
            [
                [info[key][name] for name in names[key]] if key in names else info[key]
                for info in its
            ]
            for its in motions
        ]
        flags = key.endswith(("contact", "contacts"))
        column = np.array(rows, dtype=bool if flags else np.float64)
        columns[key] = column.reshape(shape) if shape and column.size else column
    return Columns(schema=task.schema, **columns)


@pytest.fixture(scope="session")
def motions() -> Columns:
    """Four motions at the faucet: two pass over it, two turn its hot tap."""
    infos = []
    for touched, opened in (((), 0.0), ((), 0.0), (("hot_tap",), 0.5), (("hot_tap",), 1.0)):
        place = len(infos)
        infos.append(
            [
                _info(
                    FAUCET,
                    gripper=(0.5, 0.001 * k + 0.01 * place, 0.3),
                    touched=touched if k >= 10 * place else (),
                    opened=opened * k / MOMENTS,
                )
                for k in range(MOMENTS)
            ]
        )
    return columns_of(FAUCET, infos)
