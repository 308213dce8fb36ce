"""The loop of a run: ask, evaluate, tell, observe."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from lqd_search.evaluation.values import Values
from lqd_search.methods.method import Method

Evaluate = Callable[[NDArray[np.float64]], Values]
"""Turns (N, dim) solutions into their values."""


@dataclass(frozen=True, eq=False)
class Generation:
    """A generation that a method has been told.

    Attributes:
        stage: What the method was doing.
        evaluation: Number of its first evaluation.
        solutions: (N, dim) float64.
        values: What they came to.
    """

    stage: str
    evaluation: int
    solutions: NDArray[np.float64]
    values: Values


Observe = Callable[[Generation], None]
"""Is shown each generation after the method has been told of it."""


def search(method: Method, evaluate: Evaluate, *, observe: Observe | None = None) -> None:
    """Run a method until its evaluations are spent.

    Args:
        method: What asks for solutions and is told their values.
        evaluate: What evaluates them.
        observe: Called after each generation.
    """
    while not method.done:
        stage, evaluation = method.stage, method.evaluations
        solutions = method.ask()
        values = evaluate(solutions)
        method.tell(values)
        if observe is not None:
            observe(Generation(stage, evaluation, solutions, values))
