"""From solutions to values: simulate, judge, and note what only a report may know."""

from collections import deque
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from lqd_envs import SolutionSpace, Task, Trajectories
from lqd_envs.motion import MotionPlan, plan_in_scene
from lqd_envs.rollout import simulate
from lqd_envs.scene import Scene, load_scene
from lqd_search.evaluation.concatenation import concatenate_values
from lqd_search.evaluation.contact import CONTACT, first_contacts
from lqd_search.evaluation.judge import Judge
from lqd_search.evaluation.values import Values

if TYPE_CHECKING:
    # A worker that only evaluates need not import pyribs, which takes seconds.
    from ribs.typing import FieldDesc

EXPERT = "expert"
"""Passive column: (N,) bool, the expert's verdict."""
GROUND_TRUTH = "ground_truth"
"""Passive column: (N, d) float64, the ground-truth measures; NaN where undefined."""
DIGEST = "digest"
"""Passive column: (N,) uint64, a fingerprint of the motion's perception."""
VERDICT = "verdict"
"""Passive column: (N,) uint8, an `lqd_envs.Verdict` each."""

# How many chunks are planned or simulated at most while one is judged.
_AHEAD = 2


def passive_fields(task: Task) -> "FieldDesc":
    """Return the passive columns that are stored with each elite, in pyribs' form.

    Pass them as the `passive_fields` of a `LanguageDrivenQD` that is told the values of a
    `MotionEvaluator`, and the archive will say which of its elites the expert approves.

    Args:
        task: The task.
    """
    return {
        EXPERT: ((), np.bool_),
        GROUND_TRUTH: ((len(task.ground_truth.dims),), np.float64),
        DIGEST: ((), np.uint64),
    }


@dataclass(frozen=True)
class MotionEvaluator:
    """Simulates solutions in a task and lets a judge turn the motions into values.

    An inferred functional sees the motions' infos and nothing else; the expert's verdict and the
    ground-truth measures are added afterwards, as passive columns that no search reads. A method is
    asked for solutions and told their values until it is done:

        while not method.done:
            method.tell(evaluate(method.ask()))

    The motions of one chunk are judged while those of the next are simulated, and those after
    them are planned.

    Attributes:
        task: The task.
        judge: Turns the motions into values.
        threads: Threads to simulate on; 0: one for each CPU. The values do not depend on it.
        chunk: Solutions that are simulated at once. The values do not depend on it.
    """

    task: Task
    judge: Judge
    threads: int = 0
    chunk: int = 512

    def __call__(self, solutions: NDArray[np.float64]) -> Values:
        """Evaluate (N, 9) solutions; the values carry four passive columns and the contacts."""
        return concatenate_values(list(map(self._judged, self._simulated(solutions))))

    def _simulated(self, solutions: NDArray[np.float64]) -> Iterator[Trajectories]:
        """Yield the motions chunk by chunk, while the next ones are planned and simulated."""
        scene = load_scene(self.task)
        checked = SolutionSpace().require_feasible(solutions)
        # Most of planning is Python, physics needs none: with a thread for each, all CPUs are busy.
        with ThreadPoolExecutor(1) as planner, ThreadPoolExecutor(1) as simulator:
            simulated = deque[Future[Trajectories]]()
            for start in range(0, max(len(checked), 1), self.chunk):
                chunk = checked[start : start + self.chunk]
                plan = planner.submit(plan_in_scene, scene, chunk, threads=self.threads)
                simulated.append(simulator.submit(self._simulate, scene, chunk, plan))
                if len(simulated) > _AHEAD:
                    yield simulated.popleft().result()
            while simulated:
                yield simulated.popleft().result()

    def _simulate(
        self, scene: Scene, solutions: NDArray[np.float64], plan: Future[MotionPlan]
    ) -> Trajectories:
        return simulate(scene, solutions, plan.result(), threads=self.threads)

    def _judged(self, trajectories: Trajectories) -> Values:
        return replace(
            self.judge(trajectories),
            passive={
                EXPERT: trajectories.success(),
                GROUND_TRUTH: trajectories.ground_truth(),
                DIGEST: trajectories.digests(),
                VERDICT: trajectories.verdicts,
            },
            perceived={CONTACT: first_contacts(trajectories)},
        )
