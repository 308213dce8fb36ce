"""Evaluators steered by the recordings that ship with the package."""

from lqd_envs import Task
from lqd_search.cli.checked_functionals import CheckedFunctionals, infer_functionals
from lqd_search.cli.evaluator_recipe import EvaluatorRecipe
from lqd_search.cli.llm_options import LLMOptions
from lqd_search.methods.steering import STEERING


def recorded_functionals(task: Task, *, sample: int) -> CheckedFunctionals:
    """Return the functionals of a recorded sample, checked as `lqd run` checks them.

    Args:
        task: The task.
        sample: Number of the sample.
    """
    return infer_functionals(
        task,
        llm=LLMOptions(),
        instruction=task.instruction,
        sample=sample,
        threads=1,
        allow_weak=False,
        transcript=None,
    )


def recorded_recipe(task: Task, *, method: str, sample: int, threads: int) -> EvaluatorRecipe:
    """Return how to make a method's evaluator with the functionals of a recorded sample.

    Args:
        task: The task.
        method: Name of the method.
        sample: Number of the sample.
        threads: Threads to simulate on; 0: one for each CPU.
    """
    checked = recorded_functionals(task, sample=sample)
    return EvaluatorRecipe.of(
        task.id,
        steering=STEERING[method],
        functions=checked.texts,
        lengths=checked.lengths,
        threads=threads,
    )
