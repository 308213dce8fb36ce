"""Golden verdicts: what an instance asks, and its scene, are those of the declared rules."""

import numpy as np
import pytest

from benchmarks.instances.declared import RULES
from lqd_envs import get_task, rollout
from lqd_envs.instances import KINDS, generate_instances
from lqd_envs.tasks.examples import example_solutions

NAMES = ("Drawer", "Faucet", "Grasp", "Push")
# Of the examples these move the object farthest.
MOVING = slice(64, 80)
GOLDEN = {
    ("Drawer", "predicate"): "0000 0000 0000 0000 0000 4000 4000 0000 0000 0000 0000 0000",
    ("Drawer", "obstacles"): "4000 4000 0000",
    ("Drawer", "approach"): "1588 1588 8805 8845 6050 0222 1588 1588 1508 17aa 0800 1580",
    ("Drawer", "change"): "0400 4000 0000",
    ("Faucet", "predicate"): "0000 0000 4000 4b7a 0000 4b7a 0000 0000 4000 4000 0000 0000",
    ("Faucet", "obstacles"): "0142 0002 0000",
    ("Faucet", "approach"): "0000 0000 4242 0400 4240 0000 0000 a0a5 a485 0400 0808 0000",
    ("Faucet", "change"): "4b9a 0b52 0000",
    ("Grasp", "predicate"): "0000 0000 0008 2000 0000 0000 0100 1028 0008 2100 0008 2102",
    ("Grasp", "obstacles"): "0000 8188 8086",
    ("Grasp", "approach"): "0017 a922 5600 8010 80c0 1400 44e8 5400 1400 4200 80e8 c0c8",
    ("Grasp", "change"): "1004 78be b0d0",
    ("Push", "predicate"): "0000 0000 0000 0000 0000 0000 0261 0000 0070 0000 0000 0004",
    ("Push", "obstacles"): "0040 1241 1240",
    ("Push", "approach"): "a9fa 80d0 1400 c0e8 5648 1600 5400 6b68 0007 80f0 a9fa 4068",
    ("Push", "change"): "1045 9640 1000",
}
CHANGED = (
    "Expected the verdicts of the rules {}, but got others: where what an instance asks or its "
    "scene is meant to be another one now, raise RULES, so that archives are judged again, and "
    "write down the new verdicts."
)


def verdicts(name, kind):
    """Return, of each instance, which of the motions have what it asks, or solve it.

    Each is four hexadecimal digits, a bit for each motion.
    """
    task = get_task(f"LQD/{name}-v0")
    solutions = example_solutions(task)[MOVING]
    motions = rollout(task, solutions)
    found = []
    for instance in generate_instances(task, kind, count=12, seed=0):
        if instance.same_dynamics:
            condition = instance.predicate or instance.approach
            found.append(condition.holds(motions.columns))
        elif len(found) < 3:
            found.append(rollout(instance.apply(task), solutions).success())
    return " ".join(np.packbits(solved).tobytes().hex() for solved in found)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", NAMES)
def test_verdicts_are_those_of_the_declared_rules(name, kind):
    found = verdicts(name, kind)

    assert (RULES, found) == (1, GOLDEN[name, kind]), CHANGED.format(RULES)
