"""Trying motions of an archive in an instance."""

import numpy as np
import pytest

from lqd_envs import get_task
from lqd_envs.instances import Instance, InstanceError, JointBand
from lqd_search.adaptation import AdaptationError, ArchiveView, replay_in, try_motions
from lqd_search.adaptation.selectors import best_first
from lqd_search.runs.replay import ReplayError

FAUCET = get_task("LQD/Faucet-v0")
# Both open the hot tap; the first and the last touch nothing.
TURNING = (
    (0.19, 0.47, -0.17, -0.73, 0.88, -2.01, 0.4, -0.1, 0.32),
    (0.09, -0.58, -0.13, -1.05, -0.42, -0.56, -0.44, 0.54, 0.16),
)
IN_THE_AIR = (0.0, 0.0, 0.9, 0.0, 0.0, 0.0, 0.0, 0.0, 0.5)
SOLUTIONS = np.array([IN_THE_AIR, *TURNING, IN_THE_AIR])
OPENED = Instance(FAUCET.id, predicate=JointBand("hot_tap", 0.3, 2.1))


def attempts(archive, instance=OPENED, **options):
    settings = {"select": best_first, "limit": 10, "threads": 1} | options
    return try_motions(ArchiveView.of(archive), task=FAUCET, instance=instance, **settings)


def test_tries_are_counted_in_the_order_of_the_selector(make_archive):
    archive = make_archive(4, solution=SOLUTIONS, objective=np.array([4.0, 2.0, 3.0, 5.0]))

    found = attempts(archive)

    assert found.rows.tolist() == [3, 0, 2, 1]
    assert found.solved.tolist() == [False, False, True, True]
    assert found.tries == 3
    assert found.solving.tolist() == [2, 1]
    assert found.candidates == 4


def test_what_the_condition_refuses_is_not_tried_whatever_the_expert_says(make_archive):
    archive = make_archive(
        4,
        solution=SOLUTIONS,
        success=np.array([True, False, True, True]),
        expert=np.array([False, True, False, False]),
    )

    found = attempts(archive)

    assert sorted(found.rows) == [0, 2, 3]
    assert found.solving.tolist() == [2]


def test_no_more_are_tried_than_the_limit(make_archive):
    archive = make_archive(4, solution=SOLUTIONS, objective=np.array([4.0, 2.0, 3.0, 5.0]))

    found = attempts(archive, limit=2)

    assert (found.rows.tolist(), found.tries, found.candidates) == ([3, 0], None, 4)


def test_an_archive_without_a_success_is_an_error(make_archive):
    with pytest.raises(AdaptationError, match="none of its 4 elites is one by the condition that"):
        attempts(make_archive(4, success=np.zeros(4, bool)))


def test_an_instance_of_another_task_is_an_error(make_archive):
    with pytest.raises(InstanceError, match="use it with its own task"):
        attempts(make_archive(4), Instance("LQD/Push-v0"))


def test_a_replay_in_an_instance_is_that_of_the_batch():
    shown = replay_in(OPENED, SOLUTIONS[1])

    assert shown.success
    assert shown.same_as_batch
    assert len(shown.infos) == 76
    assert "is_success" not in shown.infos[-1]
    assert not replay_in(OPENED, SOLUTIONS[0]).success


def test_a_solution_that_cannot_start_is_not_replayed():
    below = np.array([0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.5])

    with pytest.raises(ReplayError, match="its start is unreachable or overlaps the scene"):
        replay_in(OPENED, below)
