"""The faucet's scene, random motions of every task, and contacts read without any sensor."""

# Before anything imports mujoco, which chooses its OpenGL backend once and for all.
from lqd_envs import SolutionSpace, Task, Trajectories, get_task, rollout

# isort: split
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import mujoco
import numpy as np
import pytest
from numpy.typing import ArrayLike, NDArray

from lqd_envs.scene import Scene, load_scene

BATCH = 240

# The solver presses something more than 3 mm into the object, and the task is done in the end: the
# expert alone would call each of them a success.
DISCARDED = {
    "LQD/Grasp-v0": (-0.12, 0.25, 0.3, 0.88, -1.06, -2.11, 0.3, 0.12, 0.29),
    "LQD/Faucet-v0": (0.03, 0.83, -0.26, -0.5, 1.04, 1.86, -0.37, -0.27, 0.0),
    "LQD/Drawer-v0": (-0.6, -0.27, -0.24, 0.35, -0.16, -1.11, -0.85, -0.01, 0.03),
    "LQD/Push-v0": (0.16, 0.29, -0.11, -0.18, 0.24, 0.84, 0.71, -0.24, 0.0),
}

# Turns the hot tap by 1.57 rad, first on its own and then along the faucet's base.
TURNING = (0.07, 0.68, -0.05, 0.47, -0.83, 2.41, -0.47, -0.51, 0.06)


@dataclass(frozen=True)
class RobotContact:
    """A contact of the robot with anything else.

    Attributes:
        robot: Name of the robot's body.
        body: Name of the other body, `world` for the table.
        geom: Name of the other geom.
        distance: In m, below 0 where they are inside each other.
    """

    robot: str
    body: str
    geom: str
    distance: float


ContactReader = Callable[[mujoco.MjData], list[RobotContact]]
StateMaker = Callable[[ArrayLike], mujoco.MjData]
MotionsOf = Callable[[str], Trajectories]


@pytest.fixture(scope="session")
def faucet() -> Task:
    return get_task("LQD/Faucet-v0")


@pytest.fixture(scope="session")
def scene(faucet: Task) -> Scene:
    return load_scene(faucet)


@pytest.fixture(scope="session")
def space() -> SolutionSpace:
    return SolutionSpace()


@pytest.fixture(scope="session")
def solutions(space: SolutionSpace) -> NDArray[np.float64]:
    """Uniform random solutions, more than 200."""
    return space.sample(BATCH, rng=np.random.default_rng(0))


@pytest.fixture(scope="session")
def trajectories(faucet: Task, solutions: NDArray[np.float64]) -> Trajectories:
    return rollout(faucet, solutions)


@pytest.fixture(scope="session")
def motions_of(solutions: NDArray[np.float64]) -> MotionsOf:
    """A function that gives the same uniform random solutions' motions in any task."""
    return cache(lambda task_id: rollout(task_id, solutions))


@pytest.fixture(scope="session")
def discarded_motion() -> MotionsOf:
    """A function that gives one motion of a paper's task that is discarded."""
    return cache(lambda task_id: rollout(task_id, np.array([DISCARDED[task_id]])))


@pytest.fixture(scope="session")
def turning_solution() -> NDArray[np.float64]:
    """(9,): a motion that turns on the hot water."""
    return np.array(TURNING)


@pytest.fixture(scope="session")
def turning(faucet: Task, turning_solution: NDArray[np.float64]) -> Trajectories:
    """The one motion that turns on the hot water."""
    return rollout(faucet, turning_solution[None])


@pytest.fixture(scope="session")
def started(scene: Scene) -> StateMaker:
    """A function that puts the arm somewhere, fingers open, by plain `mj_forward`."""

    def start(arm: ArrayLike) -> mujoco.MjData:
        data = mujoco.MjData(scene.model)
        data.qpos[:] = scene.start_qpos(arm)
        mujoco.mj_forward(scene.model, data)
        return data

    return start


@pytest.fixture(scope="session")
def robot_contacts(scene: Scene) -> ContactReader:
    """A function that lists the robot's contacts from `data.contact`."""
    model = scene.model
    robot = model.body("panda0_link0").id

    def read(data: mujoco.MjData) -> list[RobotContact]:
        contacts = []
        for contact in data.contact:
            bodies = [int(model.geom_bodyid[geom]) for geom in contact.geom]
            of_robot = [bool(model.body_rootid[body] == robot) for body in bodies]
            if sum(of_robot) == 1:
                mine, other = (0, 1) if of_robot[0] else (1, 0)
                contacts.append(
                    RobotContact(
                        robot=model.body(bodies[mine]).name,
                        body=model.body(bodies[other]).name,
                        geom=model.geom(contact.geom[other]).name,
                        distance=float(contact.dist),
                    )
                )
        return contacts

    return read
