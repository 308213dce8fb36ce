"""A task instance: what is particular about one occasion on which a task is to be done."""

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from hashlib import blake2b
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lqd_envs.instances.approach_limit import ApproachLimit
from lqd_envs.instances.given_parts import checked_obstacles, require_part, require_written
from lqd_envs.instances.instance_error import InstanceError
from lqd_envs.instances.instance_scene import InstanceScene
from lqd_envs.instances.instance_success import InstanceSuccess
from lqd_envs.instances.moved_nearness import MovedNearness
from lqd_envs.instances.obstacle import Obstacle
from lqd_envs.instances.plain_parts import read_part, read_predicate, require_keys
from lqd_envs.instances.predicate import Predicate
from lqd_envs.instances.scene_change import SceneChange
from lqd_envs.tasks.registry import get_task
from lqd_envs.tasks.task import Task
from lqd_envs.trajectories import Trajectories


@dataclass(frozen=True)
class Instance:
    """One occasion on which a task is to be done, that was not named beforehand.

    A motion solves it if the task's expert calls it a success and every part that the instance
    has is met: the predicate and the approach limit hold, and the robot touched no obstacle, all
    of it in the changed scene.

    Attributes:
        task: Id of the task.
        predicate: A condition on the motion, or None.
        obstacles: Boxes in the scene.
        approach: A limit on the direction that the gripper comes from, or None.
        change: What is different about the object, or None.
    """

    task: str
    predicate: Predicate | None = None
    obstacles: tuple[Obstacle, ...] = ()
    approach: ApproachLimit | None = None
    change: SceneChange | None = None

    def __post_init__(self) -> None:
        if not isinstance(self.task, str):
            raise InstanceError(
                f"Expected `task` to be the id of a task, but got {self.task!r}; name one, such as "
                "LQD/Faucet-v0."
            )
        require_part(self.predicate, Predicate, name="predicate")
        if self.predicate is not None:
            require_written(self.predicate)
        object.__setattr__(self, "obstacles", checked_obstacles(self.obstacles))
        require_part(self.approach, ApproachLimit, name="approach")
        require_part(self.change, SceneChange, name="change")

    @property
    def kind(self) -> str:
        """Names of the parts that it has, joined by `+`; `plain` where it has none."""
        parts = {
            "predicate": self.predicate,
            "obstacles": self.obstacles or None,
            "approach": self.approach,
            "change": self.change,
        }
        return "+".join(name for name, part in parts.items() if part is not None) or "plain"

    @property
    def name(self) -> str:
        """A short name that is the same for equal instances and on every machine.

        Such as `faucet-predicate-24b0414c`: task, kind, and a digest of all that it is.
        """
        digest = blake2b(self.to_json().encode(), digest_size=4).hexdigest()
        return f"{get_task(self.task).name}-{self.kind}-{digest}"

    @property
    def same_dynamics(self) -> bool:
        """Whether motions go in it as they go in the task itself."""
        return not self.obstacles and self.change is None

    def apply(self, task: Task) -> Task:
        """Return the task as it is in this instance, for `rollout` and `plan_motions`.

        It has the task's id, perception and centre; its scene and success are the instance's. Its
        nearness is the task's own but for a change, which moves it along with the object: it knows
        of no predicate, approach limit or obstacle. Solutions stay relative to the task's own
        centre where the object was moved: the robot is not told.

        Args:
            task: The task.

        Raises:
            InstanceError: It is an instance of another task, or says something about the object
                that this one's object does not have, or the task is that of an instance already.
        """
        if task.id != self.task:
            raise InstanceError(
                f"Expected an instance of {task.id}, but got one of {self.task}; use it with its "
                "own task."
            )
        if _in_an_instance(task):
            raise InstanceError(
                f"Expected {task.id} itself, but got it as it is in an instance already; make one "
                "Instance with the parts of both, and take the task from get_task."
            )
        if self.predicate is not None:
            self.predicate.require_fits(task)
        varied = task
        if self.predicate is not None or self.approach is not None:
            success = InstanceSuccess(task.success, self.predicate, self.approach)
            varied = replace(varied, success=success)
        if self.change is not None:
            nearness = MovedNearness(task.nearness, task.center, self.change)
            varied = replace(varied, nearness=nearness)
        if not self.same_dynamics:
            scene = InstanceScene(
                task.build_scene, task.base, task.center, self.obstacles, self.change
            )
            varied = replace(varied, build_scene=scene)
        return varied

    def solved_by(self, trajectories: Trajectories) -> NDArray[np.bool_]:
        """Return which motions, simulated in the task itself, solve the instance.

        It spares the simulation, and gives the same as
        `rollout(instance.apply(task), solutions).success()`.

        Args:
            trajectories: Motions simulated in the task.

        Returns:
            (N,) bool.

        Raises:
            InstanceError: Motions go otherwise in the instance, so that they must be simulated
                there, or the trajectories are of another task or of an instance.
        """
        if not self.same_dynamics:
            raise InstanceError(
                f"Expected an instance without obstacles and changes, but got {self.name}; "
                "simulate the motions in it, with rollout(instance.apply(task), solutions)."
            )
        own = trajectories.task
        if _in_an_instance(own):
            raise InstanceError(
                "Expected motions that were simulated in the task itself, but got those of an "
                "instance; pass rollout(task, solutions)."
            )
        varied = self.apply(own)
        return replace(trajectories, task=varied).success()

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain dictionaries, lists, numbers and strings."""
        plain: dict[str, Any] = json.loads(self.to_json())
        return plain

    def to_json(self) -> str:
        """Return it as one line of JSON, equal for equal instances."""
        return json.dumps(asdict(self), sort_keys=True, allow_nan=False)

    @classmethod
    def from_dict(cls, plain: object) -> "Instance":
        """Return the instance that `to_dict` made a dictionary of.

        Args:
            plain: The dictionary; what it leaves out is left out of the instance.

        Raises:
            InstanceError: It is not the dictionary of an instance.
        """
        given = require_keys(cls, plain, name="an instance")
        obstacles = given.get("obstacles", ())
        if obstacles is None:
            obstacles = ()
        if not isinstance(obstacles, list | tuple):
            raise InstanceError(
                f"Expected `obstacles` to be a list of boxes, but got {obstacles!r}; put it into "
                "brackets."
            )
        predicate, approach, change = map(given.get, ("predicate", "approach", "change"))
        return cls(
            task=given["task"],
            predicate=None if predicate is None else read_predicate(predicate),
            obstacles=tuple(read_part(Obstacle, box, name="an obstacle") for box in obstacles),
            approach=(
                None
                if approach is None
                else read_part(ApproachLimit, approach, name="an approach limit")
            ),
            change=None if change is None else read_part(SceneChange, change, name="a change"),
        )

    @classmethod
    def from_json(cls, text: str) -> "Instance":
        """Return the instance that `to_json` wrote.

        Raises:
            InstanceError: The text is no JSON, or not that of an instance.
        """
        try:
            plain = json.loads(text)
        except (ValueError, RecursionError) as error:
            raise InstanceError(
                f"Expected an instance as JSON, but got text that is none ({error}); write it with "
                "Instance.to_json."
            ) from error
        return cls.from_dict(plain)


def _in_an_instance(task: Task) -> bool:
    return isinstance(task.build_scene, InstanceScene) or isinstance(task.success, InstanceSuccess)


def task_of(task_id: str, instance: Instance | Mapping[str, Any] | None) -> Task:
    """Return the task of an id, as it is in an instance if there is one.

    Args:
        task_id: Id of a registered task.
        instance: An instance of it, the dictionary of one, or None.

    Raises:
        UnknownTaskError: There is no task of that id.
        InstanceError: The instance is none, or not of this task.
    """
    task = get_task(task_id)
    if instance is None:
        return task
    if not isinstance(instance, Instance):
        instance = Instance.from_dict(instance)
    return instance.apply(task)
