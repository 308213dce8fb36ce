"""Robot manipulation tasks for language-driven quality-diversity, as Gymnasium environments.

Importing this package registers the environments: `gymnasium.make("LQD/Faucet-v0")`.
"""

# Before anything imports mujoco, which chooses its OpenGL backend once and for all.
from lqd_envs.rendering_backend import choose_headless_backend

choose_headless_backend()

from lqd_envs.env import ManipulationEnv  # noqa: E402
from lqd_envs.errors import LQDError  # noqa: E402
from lqd_envs.inputs import ResetError  # noqa: E402
from lqd_envs.motion import MotionPlan, plan_motions  # noqa: E402
from lqd_envs.perception import (  # noqa: E402
    Columns,
    DescriptorFunction,
    FitnessFunction,
    Info,
    Infos,
    ObjectJoint,
    PerceptionSchema,
    QuantityFunction,
    SuccessFunction,
    TimestampFunction,
)
from lqd_envs.registration import register_task  # noqa: E402
from lqd_envs.rendering import RenderingError  # noqa: E402
from lqd_envs.rollout import rollout  # noqa: E402
from lqd_envs.solution_space import SolutionError, SolutionSpace  # noqa: E402
from lqd_envs.tasks.registry import (  # noqa: E402
    PAPER_TASKS,
    TASKS,
    DuplicateTaskError,
    UnknownTaskError,
    get_task,
)
from lqd_envs.tasks.task import GroundTruth, Task  # noqa: E402
from lqd_envs.trajectories import Trajectories  # noqa: E402
from lqd_envs.vector_env import ManipulationVectorEnv  # noqa: E402
from lqd_envs.verdict import Verdict  # noqa: E402

for _task in PAPER_TASKS:
    register_task(_task)

__all__ = [
    "PAPER_TASKS",
    "TASKS",
    "Columns",
    "DescriptorFunction",
    "DuplicateTaskError",
    "FitnessFunction",
    "GroundTruth",
    "Info",
    "Infos",
    "LQDError",
    "ManipulationEnv",
    "ManipulationVectorEnv",
    "MotionPlan",
    "ObjectJoint",
    "PerceptionSchema",
    "QuantityFunction",
    "RenderingError",
    "ResetError",
    "SolutionError",
    "SolutionSpace",
    "SuccessFunction",
    "Task",
    "TimestampFunction",
    "Trajectories",
    "UnknownTaskError",
    "Verdict",
    "get_task",
    "plan_motions",
    "register_task",
    "rollout",
]
