"""The loop of a run: ask, evaluate, tell, observe."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from lqd_search.evaluation.values import Values
from lqd_search.methods.method import Method

Evaluate = Callable[[NDArray[np.float64]], Values]
"""Turns (N, dim) solutions into their values."""
Observe = Callable[[str, Values], None]
"""Is told, after each generation, the stage that it belonged to and its values."""


def search(method: Method, evaluate: Evaluate, *, observe: Observe) -> None:
    """Run a method until its evaluations are spent.

    Args:
        method: What asks for solutions and is told their values.
        evaluate: What evaluates them.
        observe: Called after each generation.
    """
    while not method.done:
        stage = method.stage
        values = evaluate(method.ask())
        method.tell(values)
        observe(stage, values)
