import numpy as np
import pytest

from lqd_search.emitters.random_emitter import RandomEmitter


@pytest.mark.parametrize("n", [0, 1, 5])
def test_it_samples_whatever_there_is(toy, archive_of, batch_of, n):
    emitter = RandomEmitter(toy)
    archive = archive_of({"a": [1]}, success=[1])
    solutions = emitter.ask(n, archive=archive, rng=np.random.default_rng(4))
    assert solutions.tolist() == toy.sample(n, rng=np.random.default_rng(4)).tolist()
    emitter.tell(batch_of(solutions), archive=archive)
    again = emitter.ask(n, archive=archive, rng=np.random.default_rng(4))
    assert again.tolist() == solutions.tolist()
