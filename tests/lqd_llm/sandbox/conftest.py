"""Real motions, and sandboxes to run functions in."""

import gc
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from lqd_envs import SolutionSpace, rollout
from lqd_llm.sandbox import check_source
from lqd_llm.sandbox.functions import SandboxedFunction
from lqd_llm.sandbox.info_layout import InfoLayout
from lqd_llm.sandbox.roles import Role


@pytest.fixture(scope="session")
def motions_of():
    """A function that gives the valid ones of 80 random motions in a task, simulated once."""

    @cache
    def simulate(task_id):
        trajectories = rollout(task_id, SolutionSpace().sample(80, rng=np.random.default_rng(0)))
        return trajectories.rows(np.flatnonzero(trajectories.valid))

    return simulate


@pytest.fixture(scope="session")
def layout_of():
    """A function that gives the layout of columns."""

    def layout(columns):
        joints = [joint.name for joint in columns.schema.joints]
        names = {"gripper_contacts": columns.schema.links, "joint_positions": joints}
        return InfoLayout.of(columns.arrays(), names=names)

    return layout


@pytest.fixture(scope="session")
def mugs(motions_of):
    """The columns of ten motions near the mug."""
    return motions_of("LQD/Grasp-v0").columns.rows(np.arange(10))


@pytest.fixture(scope="session")
def layout(mugs, layout_of):
    return layout_of(mugs)


@pytest.fixture(scope="session")
def function():
    """A function that makes a `SandboxedFunction` of a role from the lines of its body."""

    def make(role, *body, name="it"):
        argument = "info" if role in (Role.FITNESS, Role.QUANTITY) else "infos"
        code = "\n    ".join([f"def entry({argument}):", *body]) + "\n"
        return SandboxedFunction(name, role, check_source(code, entry="entry"))

    return make


@pytest.fixture
def several(function):
    """One function of each role, and two quantities."""
    return [
        function(Role.SUCCESS, "return infos[-1]['object_position'][2] > 0.01", name="lifted"),
        function(Role.FITNESS, "return info['object_position'][2]", name="height"),
        function(Role.TIMESTAMP, "return infos[-1]", name="end"),
        function(Role.TIMESTAMP, "return None", name="never"),
        function(Role.QUANTITY, "return info['gripper_position'][:2]", name="xy"),
        function(Role.QUANTITY, "return info['gripper_orientation']", name="rpy"),
        function(Role.DESCRIPTOR, "return infos[0]['gripper_position']", name="start"),
    ]


@pytest.fixture
def open_files():
    """A function that counts the files that this process has open."""

    def count():
        gc.collect()
        return len(list(Path("/proc/self/fd").iterdir()))

    return count
