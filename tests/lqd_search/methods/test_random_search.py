from dataclasses import dataclass

import numpy as np

from lqd_search import Values
from lqd_search.methods.random_search import RandomSearch


@dataclass(frozen=True)
class Die:
    """One of six solutions, the last of which fails."""

    dim: int = 1

    def sample(self, n, *, rng):
        return rng.integers(0, 6, (n, 1)).astype(float)

    def evaluate(self, solutions):
        valid = solutions[:, 0] < 5.0
        return Values(valid=valid, success=valid, fitness={"eyes": solutions[:, 0]}, measures={})


def new_search(space, **options):
    return RandomSearch(
        space,
        **({"evaluations": 100, "batch_size": 32, "rng": np.random.default_rng(0)} | options),
    )


def finish(method, problem):
    generations = []
    while not method.done:
        assert method.stage == "sampling"
        generations.append(method.ask())
        method.tell(problem.evaluate(generations[-1]))
    return np.concatenate(generations)


def test_it_samples_and_puts_out_all_that_is_valid(toy):
    method = new_search(toy, fitness="near")
    asked = finish(method, toy)
    rng = np.random.default_rng(0)
    assert (
        asked.tolist() == np.concatenate([toy.sample(n, rng=rng) for n in (32, 32, 32, 4)]).tolist()
    )
    assert method.output()["solution"].tolist() == asked[toy.evaluate(asked).valid].tolist()


def test_equal_solutions_are_put_out_once_as_evaluated_first():
    die = Die()
    method = new_search(die, fitness="eyes")
    asked = finish(method, die)[:, 0].tolist()
    output = method.output()
    assert sorted(output["solution"][:, 0]) == [0.0, 1.0, 2.0, 3.0, 4.0]
    assert output["evaluation"].tolist() == sorted(asked.index(eyes) for eyes in range(5))
