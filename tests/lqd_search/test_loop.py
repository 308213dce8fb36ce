import numpy as np

from lqd_search.evaluation.values import Values
from lqd_search.loop import search


class CountingMethod:
    """Three batches of two, each told what was asked for."""

    def __init__(self) -> None:
        self.evaluations = 0
        self.told: list[Values] = []

    @property
    def done(self) -> bool:
        return self.evaluations == 6

    @property
    def stage(self) -> str:
        return f"at {self.evaluations}"

    def ask(self):
        return np.full((2, 9), float(self.evaluations))

    def tell(self, values) -> None:
        self.told.append(values)
        self.evaluations += 2


def test_asks_evaluates_tells_and_observes_in_turn():
    method, observed = CountingMethod(), []

    def evaluate(solutions):
        valid = np.ones(len(solutions), dtype=bool)
        return Values(valid=valid, success=~valid, fitness={"first": solutions[:, 0]}, measures={})

    search(method, evaluate, observe=observed.append)

    assert [seen.stage for seen in observed] == ["at 0", "at 2", "at 4"]
    assert [seen.evaluation for seen in observed] == [0, 2, 4]
    assert [seen.values.fitness["first"][0] for seen in observed] == [0.0, 2.0, 4.0]
    assert [seen.solutions[0, 0] for seen in observed] == [0.0, 2.0, 4.0]
    assert [seen.values for seen in observed] == method.told
