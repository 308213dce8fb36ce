"""Recorded success conditions beside each other, on the same motions."""

import numpy as np
import pytest

from benchmarks.conditions import describe, judge, recorded_conditions
from benchmarks.plain_functions import plain_function
from benchmarks.random_trajectories import random_trajectories
from benchmarks.recorded_recipe import recorded_functionals
from benchmarks.tables.cell_figures import Verdicts
from lqd_envs import get_task

TASK = get_task("LQD/Faucet-v0")


def motions():
    return random_trajectories(TASK, most=600, rng=np.random.default_rng(0))


@pytest.fixture(scope="module")
def conditions():
    return list(recorded_conditions(TASK))


@pytest.mark.slow
def test_each_recording_has_two(conditions):
    names = [f"{steering}_{k}" for k in range(5) for steering in ("mesh", "direct")]

    assert [condition.name for condition in conditions] == names


@pytest.mark.slow
def test_what_they_approve_is_counted_beside_the_expert(conditions):
    found = judge(TASK, motions(), conditions)

    texts = {text.kind: text for text in recorded_functionals(TASK, sample=2).texts}
    (batch,) = motions()
    expert = batch.success()
    assert expert[batch.valid].any()
    for kind, name in (("success", "mesh_2"), ("direct.success", "direct_2")):
        condition = plain_function(texts[kind].code, entry="success")
        pairs = [
            (bool(condition(batch.infos(row))), bool(expert[row]))
            for row in np.flatnonzero(batch.valid).tolist()
        ]
        assert found[name] == Verdicts(
            both=pairs.count((True, True)),
            inferred_only=pairs.count((True, False)),
            expert_only=pairs.count((False, True)),
            neither=pairs.count((False, False)),
        )


def test_a_row_has_the_two_of_a_recording():
    found = {f"mesh_{k}": Verdicts(3, 1, 1, 9) for k in range(5)}
    found |= {f"direct_{k}": Verdicts(k, 0, 4 - k, 9) for k in range(5)}

    rows = describe(TASK, found)

    assert rows[1] == ("faucet", "1", "4", "0.75", "0.75", "0.25", "1.00")
    assert rows[0][-2:] == ("0.00", "nan")
