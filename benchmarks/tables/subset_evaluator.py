"""An evaluator that leaves out some descriptors."""

from collections.abc import Collection
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from lqd_search.evaluation.values import Values
from lqd_search.loop import Evaluate


@dataclass(frozen=True)
class SubsetEvaluator:
    """Evaluates solutions as another evaluator does, and leaves out some descriptors' measures.

    Attributes:
        evaluate: The other evaluator.
        descriptors: Those whose measures stay.
    """

    evaluate: Evaluate
    descriptors: Collection[str]

    def __call__(self, solutions: NDArray[np.float64]) -> Values:
        """Evaluate (N, dim) solutions."""
        values = self.evaluate(solutions)
        kept = {name: m for name, m in values.measures.items() if name in self.descriptors}
        return replace(values, measures=kept)
