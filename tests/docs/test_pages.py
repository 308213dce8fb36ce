"""Pages whose code one can paste: block by block, in one session."""

import re
from pathlib import Path

import numpy as np
import pytest

DOCS = Path(__file__).parents[2] / "docs"
BLOCK = re.compile(r"^```python\n(.*?)^```$", re.DOTALL | re.MULTILINE)


@pytest.fixture
def session():
    namespaces = []

    def run(page):
        text = "\n".join(BLOCK.findall((DOCS / page).read_text("utf-8")))
        namespace = {}
        namespaces.append(namespace)
        exec(compile(text, page, "exec"), namespace)
        return namespace

    yield run
    for namespace in namespaces:
        for name in ("env", "envs"):
            if name in namespace:
                namespace[name].close()


def test_instances_are_drawn_stepped_and_judged(session):
    said = session("instances.md")

    assert said["trajectories"].success().shape == (200,)
    assert said["envs"].num_envs == 16
    assert len(said["solved"]) == 20


def test_a_motion_is_found_and_carried_out_in_an_env(session, capsys):
    said = session("physics.md")

    assert said["actions"].shape == (75, 8)
    end = said["motions"].infos(said["row"])[-1]
    np.testing.assert_array_equal(said["info"]["gripper_position"], end["gripper_position"])
    assert capsys.readouterr().out in ("True True\n", "False False\n")
