"""What steers the run of a variant: the functionals of a recording, and their evaluator."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from benchmarks.recorded_recipe import recorded_functionals
from lqd_envs import Task, get_task
from lqd_search.cli.checked_functionals import CheckedFunctionals
from lqd_search.cli.evaluator_recipe import EvaluatorRecipe
from lqd_search.evaluation.motion_evaluator import MotionEvaluator
from lqd_search.evaluation.stopped_functions import MakeEvaluate, WithoutStopped
from lqd_search.evaluation.values import StoppedFunction
from lqd_search.methods.steering import MESH


@dataclass(frozen=True, eq=False)
class Steering:
    """What steers a run.

    Attributes:
        task: The task.
        functionals: Those of the recording, which passed their checks.
        here: Judges by all of them, with the measures of the whole mesh.
        make: Makes one that does without those that were stopped.
    """

    task: Task
    functionals: CheckedFunctionals
    here: MotionEvaluator
    make: MakeEvaluate

    def evaluate(self, stopped: tuple[StoppedFunction, ...]) -> WithoutStopped:
        """Return the evaluator of a run in which some functionals were stopped before.

        Args:
            stopped: These.
        """
        first = self.make(stopped) if stopped else self.here
        return WithoutStopped(first, make=self.make, stopped=stopped)


@contextmanager
def steered_by_recording(task_id: str, *, sample: int) -> Iterator[Steering]:
    """Make what steers a run by a recorded sample of the model's replies, on one thread.

    Args:
        task_id: The task.
        sample: Which recorded sample.

    Raises:
        LQDError: The functionals cannot be had or used, or the sandbox does not open.
    """
    task = get_task(task_id)
    functionals = recorded_functionals(task, sample=sample)
    recipe = EvaluatorRecipe.of(
        task_id,
        steering=MESH,
        functions=functionals.texts,
        lengths=functionals.lengths,
        threads=1,
    )
    with recipe.opened() as here:
        yield Steering(task, functionals, here, lambda stopped: recipe.without(stopped)())
