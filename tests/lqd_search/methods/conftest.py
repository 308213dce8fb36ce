"""What the tests of several methods need."""

import pytest

from lqd_search.methods.method import MethodError
from lqd_search.schedulers.multi_bd_scheduler import SchedulerError


class Failing:
    """An emitter that cannot learn from what it is asked for."""

    def ask(self, n, *, archive, rng):
        return archive.sample_elites(n)["solution"] * rng.uniform(0.9, 1.0)

    def tell(self, batch, *, archive):  # noqa: ARG002 -- the protocol's
        if batch.asked:
            raise OSError("out of ideas")


@pytest.fixture
def failing_emitter():
    return Failing()


@pytest.fixture
def check_told_once():
    """Return a check that a method is not told again what its emitter failed on."""

    def check(method, values, *, state):
        with pytest.raises(OSError, match="out of ideas"):
            method.tell(values)
        held = state(method)
        with pytest.raises(SchedulerError, match="since the emitter failed"):
            method.tell(values)
        with pytest.raises(MethodError, match="not told yet"):
            method.ask()
        assert state(method) == held

    return check
