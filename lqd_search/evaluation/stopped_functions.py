"""Evaluating without the functionals that were stopped, wherever that happened."""

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from lqd_search.evaluation.values import StoppedFunction, Values

if TYPE_CHECKING:
    # Its module imports the methods, which take seconds to load.
    from lqd_search.loop import Evaluate

MakeEvaluate = Callable[[tuple[StoppedFunction, ...]], "Evaluate"]
"""Makes an evaluator that calls none of the given functionals, and refuses all of their values for
the reasons that are given."""


class WithoutStopped:
    """Evaluates batches, and each batch in which a functional is stopped again without it.

    A functional that uses more than it may is stopped from outside. When that happens in a
    generation it counts as refused in the whole of it and from then on, so that the values depend
    neither on the order in which motions are judged, nor on chunks, workers, or where a run was
    stopped and gone on with.

    When timestamps are stopped, the quantities that are stopped in the same batch are given another
    chance: it may have happened on a moment that only those timestamps pick.

    Args:
        evaluate: Evaluates batches, and calls none of `stopped`.
        make: Makes the evaluator that replaces it.
        stopped: The functionals that a run that goes on had stopped before.

    Attributes:
        stopped: All that were stopped so far, in order.
    """

    def __init__(
        self,
        evaluate: "Evaluate",
        *,
        make: MakeEvaluate,
        stopped: Iterable[StoppedFunction] = (),
    ) -> None:
        self._evaluate = evaluate
        self._make = make
        self.stopped = tuple(stopped)

    def __call__(self, solutions: NDArray[np.float64]) -> Values:
        """Evaluate (N, dim) solutions.

        Returns:
            The values. Their `stopped` are the functionals that were stopped in this batch; they
            and all that were stopped before are refused in the whole batch.
        """
        earlier = len(self.stopped)
        values = self._evaluate(solutions)
        while fresh := self._fresh(values):
            self.stopped += fresh
            self._evaluate = self._make(self.stopped)
            values = self._evaluate(solutions)
        return replace(values, stopped=self.stopped[earlier:])

    def _fresh(self, values: Values) -> tuple[StoppedFunction, ...]:
        known = {(stopped.kind, stopped.functional) for stopped in self.stopped}
        fresh = [s for s in values.stopped if (s.kind, s.functional) not in known]
        if any(stopped.kind == "timestamp" for stopped in fresh):
            fresh = [stopped for stopped in fresh if stopped.kind != "quantity"]
        # Chunks that are evaluated at the same time may find them in any order.
        return tuple(sorted(fresh, key=lambda stopped: (stopped.kind, stopped.functional)))
