from dataclasses import replace

import numpy as np
import pytest

from lqd_envs import PAPER_TASKS, SolutionSpace, rollout
from lqd_envs.tasks.examples import example_solutions

RANDOM = 64


@pytest.mark.parametrize("task", PAPER_TASKS, ids=lambda task: task.name)
def test_the_chosen_examples_are_valid_and_touch_the_object(task):
    solutions = example_solutions(task)
    chosen = rollout(task, solutions[RANDOM:])
    assert SolutionSpace().feasible(solutions).all()
    assert len(chosen) == 24
    assert chosen.valid.all()
    assert np.any(chosen.columns.gripper_contacts, axis=(1, 2)).all()


def test_another_task_has_random_examples_only():
    other = replace(PAPER_TASKS[0], id="Home/Grasp-v0")
    drawn = SolutionSpace().sample(RANDOM, rng=np.random.default_rng(0))
    np.testing.assert_array_equal(example_solutions(other), drawn)
