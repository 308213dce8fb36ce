import numpy as np
import pytest

from lqd_envs import LQDError
from lqd_search.cli.stored_motion import StoredMotion, best_success
from lqd_search.runs.replay import Replay
from lqd_search.runs.stored_archive import StoredArchive

INFO = {"joint_positions": {"hot_tap": 0.5}, "gripper_position": (0.1, 0.2, 0.3)}


def archive(objective, success) -> StoredArchive:
    n = len(objective)
    return StoredArchive(
        fields={
            "solution": np.arange(9.0 * n).reshape(n, 9),
            "objective": np.array(objective),
            "success": np.array(success),
            "evaluation": 10 + np.arange(n),
            "expert": np.zeros(n, bool),
            "digest": np.arange(n, dtype=np.uint64),
        },
        grids={},
    )


@pytest.mark.parametrize(
    ("objective", "success", "best"),
    [
        ([0.5, 0.9, 0.7], [True, False, True], 2),
        ([0.5, 0.5, 0.1], [True, True, True], 0),
        ([np.nan, -3.0, np.nan], [True, True, True], 1),
        ([1.0, np.nan], [False, True], 1),
        ([1.0, -np.inf], [False, True], 1),
    ],
)
def test_the_best_is_the_success_of_the_highest_fitness(objective, success, best):
    assert best_success(archive(objective, success)) == best


def test_without_a_success_there_is_no_best():
    with pytest.raises(LQDError, match=r"none of its 2 elites is one by the condition that"):
        best_success(archive([0.0, 1.0], [False, False]))


def replay(**changes) -> Replay:
    seen = {"infos": [INFO], "success": False, "same_as_batch": True, "digest": 1, "frames": ()}
    return Replay(**seen | changes)


def test_a_replay_is_the_same_where_everything_is():
    motion = StoredMotion.elite(archive([0.0, 1.5], [False, True]), 1)

    assert motion.is_same(replay())
    for change in ({"success": True}, {"same_as_batch": False}, {"digest": 2}):
        assert not motion.is_same(replay(**change))


def test_the_report_says_what_the_run_saw_and_what_the_replay_shows():
    motion = StoredMotion.elite(archive([0.0, 1.5], [False, True]), 1)

    lines = motion.report(replay(success=True, digest=5)).splitlines()

    assert lines[0] == "elite 1 of 2, evaluation 11, fitness 1.5"
    assert lines[2:] == [
        "success: yes by the expert's condition (in the run: no; by the inferred one: yes)",
        "infos equal to a batch rollout's, bit for bit: yes",
        "infos equal to those of the run, bit for bit: no",
        "at the end: hot_tap 0.5000, gripper at [0.1, 0.2, 0.3] m",
    ]


def test_a_row_that_is_not_there_is_one_sentence():
    with pytest.raises(
        LQDError,
        match=r"^Expected an index below 2, the number of elites in the archive, got 2; choose a",
    ):
        StoredMotion.elite(archive([0.0, 1.5], [False, True]), 2)
