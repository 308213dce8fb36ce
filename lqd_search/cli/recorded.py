"""Judging by recorded functionals: what steers a run of the command line."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from lqd_envs import Infos, LQDError, Task, get_task, rollout
from lqd_envs.tasks.examples import example_solutions
from lqd_search.evaluation.direct_judge import DirectFunctionals, DirectJudge
from lqd_search.evaluation.expert_judge import ExpertJudge
from lqd_search.evaluation.functionals import FunctionalEvaluator, Functionals
from lqd_search.evaluation.judge import Judge
from lqd_search.evaluation.mesh_judge import MeshJudge
from lqd_search.evaluation.motion_evaluator import MotionEvaluator
from lqd_search.methods.steering import DIRECT, EXPERT, STEERING
from lqd_search.runs.function_text import FunctionText

if TYPE_CHECKING:
    from lqd_llm import InferredFunctionals


@dataclass(frozen=True)
class RecordedEvaluator:
    """How to make the evaluator of a method, here or on another machine.

    It can be pickled and compared, so that a worker makes the evaluator once and keeps it.

    Attributes:
        task_id: The task.
        method: Name of the method, which says what steers it.
        sample: Which recorded sample of the model's replies.
        threads: Threads to simulate on; 0: one for each CPU.
    """

    task_id: str
    method: str
    sample: int
    threads: int = 0

    def __call__(self) -> MotionEvaluator:
        """Make the evaluator.

        Raises:
            LQDError: The functionals cannot be had or cannot be used.
        """
        task = get_task(self.task_id)
        inferred = infer(task, sample=self.sample)
        judge = make_judge(task, inferred, method=self.method, threads=self.threads)
        return MotionEvaluator(task, judge, self.threads)


def infer(task: Task, *, sample: int) -> "InferredFunctionals":
    """Return what a recorded model inferred for a task.

    Raises:
        LQDError: The extra `llm` is not installed, or there is no such recording.
    """
    try:
        from lqd_llm import infer_from_recording
    except ImportError as error:
        raise LQDError(
            f"Expected the packages of the extra `llm` to infer functionals, but {error.name} is "
            "not installed; run `pip install 'lqd-envs[all]'`."
        ) from error
    return infer_from_recording(
        task.name, instruction=task.instruction, schema=task.schema, sample=sample
    )


def make_judge(
    task: Task, inferred: "InferredFunctionals", *, method: str, threads: int = 0
) -> Judge:
    """Make what steers a method.

    Args:
        task: The task.
        inferred: What the model inferred for it.
        method: Name of the method.
        threads: Threads to simulate example motions on.

    Raises:
        FunctionalError: The functionals cannot be used.
    """
    steering = STEERING[method]
    if steering == EXPERT:
        return ExpertJudge(task)
    motions = _examples(task, threads=threads)
    if steering == DIRECT:
        direct = inferred.direct
        return DirectJudge(
            DirectFunctionals(direct.success.call, direct.fitness.call, direct.descriptor.call),
            examples=motions,
        )
    functionals = Functionals(
        success=inferred.success.call,
        fitness={function.name: function.call for function in inferred.fitness},
        timestamps={function.name: function.call for function in inferred.timestamps},
        quantities={function.name: function.call for function in inferred.quantities},
    )
    moments = [info for infos in motions for info in (infos[0], infos[-1])]
    return MeshJudge(FunctionalEvaluator(functionals, examples=moments))


def function_texts(inferred: "InferredFunctionals", *, method: str) -> list[FunctionText]:
    """Return the source of the functionals that steer a method; none steer the expert's."""
    steering = STEERING[method]
    if steering == EXPERT:
        return []
    direct = inferred.direct
    kinds = (
        {
            "direct.success": (direct.success,),
            "direct.fitness": (direct.fitness,),
            "direct.descriptor": (direct.descriptor,),
        }
        if steering == DIRECT
        else {
            "success": (inferred.success,),
            "fitness": inferred.fitness,
            "timestamp": inferred.timestamps,
            "quantity": inferred.quantities,
        }
    )
    return [
        FunctionText(kind=kind, name=f.name, description=f.description, code=f.code)
        for kind, functions in kinds.items()
        for f in functions
    ]


def _examples(task: Task, *, threads: int) -> list[Infos]:
    """Return motions of the task on which it can be seen what each function gives.

    They are no part of the search.
    """
    trajectories = rollout(task, example_solutions(task), threads=threads)
    return [trajectories.infos(int(i)) for i in np.flatnonzero(trajectories.valid)]
