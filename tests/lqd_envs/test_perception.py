import json
import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from lqd_envs import PAPER_TASKS, Columns, PerceptionSchema
from lqd_envs.perception import ObjectJoint

RECORDINGS = Path(__file__).parents[2] / "llm" / "recordings"

MUG = PerceptionSchema(base="mug, the middle of its bottom", fixed=False, links=("mug",))
SCHEMAS = {
    "grasp": MUG,
    "push": MUG,
    "faucet": PerceptionSchema(
        base="faucet, where it stands on the table",
        fixed=True,
        links=("base", "hot_tap", "cold_tap"),
        joints=(
            ObjectJoint(name="hot_tap", unit="rad", upper=2 * math.pi / 3),
            ObjectJoint(name="cold_tap", unit="rad", upper=2 * math.pi / 3),
        ),
    ),
    "drawer": PerceptionSchema(
        base="chest of drawers, the middle of its bottom",
        fixed=True,
        links=("body", "drawer"),
        joints=(ObjectJoint(name="drawer", unit="m", upper=0.2),),
    ),
}
FLOATS = st.floats(allow_nan=False, allow_infinity=False)


@pytest.mark.parametrize("task", SCHEMAS)
@pytest.mark.parametrize("sample", range(5))
def test_text_is_what_the_language_model_was_shown(task, sample):
    recording = json.loads((RECORDINGS / f"{task}-{sample}.json").read_text("utf-8"))
    before, text, _ = recording["system"].partition(SCHEMAS[task].text())

    assert text
    # Nothing on the first line before it, and nothing after it but the next paragraph.
    assert before.endswith("\n")


@pytest.mark.parametrize("task", PAPER_TASKS, ids=lambda task: task.name)
def test_task_has_the_schema_of_its_recordings(task):
    assert task.schema == SCHEMAS[task.name]


@pytest.mark.parametrize("schema", SCHEMAS.values(), ids=SCHEMAS)
def test_text_is_a_class_of_eight_commented_keys(schema):
    head, *lines = schema.text().splitlines()

    assert head == "class Info(TypedDict):"
    assert len(lines) == 8
    assert {line.index("# ") for line in lines} == {54}
    namespace = {}
    exec("from typing import TypedDict\n" + schema.text(), namespace)
    assert set(namespace["Info"].__annotations__) == {
        "object_position",
        "object_orientation",
        "object_table_contact",
        "robot_table_contact",
        "gripper_position",
        "gripper_orientation",
        "gripper_contacts",
        "joint_positions",
    }


@st.composite
def columns(draw, schema):
    shape = (draw(st.integers(1, 3)), draw(st.integers(1, 4)))

    def numbers(*last):
        return draw(arrays(np.float64, (*shape, *last), elements=FLOATS))

    def flags(*last):
        return draw(arrays(np.bool_, (*shape, *last)))

    return Columns(
        schema=schema,
        object_position=numbers(3),
        object_orientation=numbers(3),
        object_table_contact=flags(),
        robot_table_contact=flags(),
        gripper_position=numbers(3),
        gripper_orientation=numbers(3),
        gripper_contacts=flags(len(schema.links)),
        joint_positions=numbers(len(schema.joints)),
    )


def read_back(columns, i):
    """The arrays of motion `i`, made from its infos again."""
    infos = columns.infos(i)
    arrays = {key: np.array([info[key] for info in infos]) for key in infos[0]}
    for key in ("gripper_contacts", "joint_positions"):
        arrays[key] = np.array([list(info[key].values()) for info in infos])
    return arrays


@pytest.mark.parametrize("schema", [SCHEMAS["faucet"], SCHEMAS["drawer"], MUG])
@settings(deadline=None, derandomize=True, max_examples=30)
@given(data=st.data())
def test_infos_hold_every_bit_of_the_columns(schema, data):
    some = data.draw(columns(schema))

    for i in range(len(some.object_position)):
        for key, values in read_back(some, i).items():
            assert values.tobytes() == getattr(some, key)[i].tobytes()
        for info in some.infos(i):
            assert tuple(info["gripper_contacts"]) == schema.links
            assert tuple(info["joint_positions"]) == tuple(j.name for j in schema.joints)


def test_wrong_number_of_links_is_an_error(trajectories):
    schema = PerceptionSchema(base="x", fixed=True, links=("one",), joints=())
    full = trajectories.columns
    wrong = Columns(**{**vars(full), "schema": schema})

    with pytest.raises(ValueError, match="zip"):
        wrong.infos(0)


@settings(deadline=None, derandomize=True, max_examples=30)
@given(data=st.data())
def test_until_a_moment_that_one_is_the_last(data):
    some = data.draw(columns(SCHEMAS["drawer"]))
    moments = some.gripper_position.shape[1]

    for moment in range(moments):
        seen = some.until(moment)
        assert seen.schema == some.schema
        for key, array in some.arrays().items():
            assert getattr(seen, key).tobytes() == array[:, : moment + 1].tobytes()
        assert seen.infos(0) == some.infos(0)[: moment + 1]
