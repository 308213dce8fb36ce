import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

from lqd_envs import LQDError, ResetError
from lqd_envs.episodes import Episodes

ALL = np.ones(3, dtype=bool)
NONE = np.zeros(3, dtype=bool)


@pytest.fixture
def episodes():
    episodes = Episodes.of(3, limit=3)
    episodes.start(np.arange(3), discarded=NONE)
    return episodes


def test_nothing_has_started_at_first():
    episodes = Episodes.of(3, limit=None)
    episodes.start(np.array([1]), discarded=np.array([False]))

    with pytest.raises(LQDError, match=r"before step\(\), but envs 0, 2 did not start"):
        episodes.require_ready(AutoresetMode.NEXT_STEP)
    with pytest.raises(ResetError, match="but env 2 would be left out"):
        episodes.require_others_started(np.array([True, False, False]))
    episodes.require_others_started(np.array([True, False, True]))


def test_what_is_discarded_stays_so_until_the_next_start(episodes):
    episodes.go_on(ALL, spoiled=np.array([True, False, False]), diverged=NONE)
    episodes.go_on(ALL, spoiled=np.array([False, True, False]), diverged=NONE)
    assert episodes.discarded.tolist() == [True, True, False]
    assert not episodes.over.any()

    episodes.start(np.array([0, 2]), discarded=np.array([False, True]))

    assert episodes.discarded.tolist() == [False, True, True]


def test_episode_is_over_at_its_limit_or_when_it_diverged(episodes):
    episodes.go_on(ALL, spoiled=NONE, diverged=np.array([False, True, False]))
    assert episodes.over.tolist() == [False, True, False]
    assert episodes.discarded.tolist() == [False, True, False]
    episodes.start(np.array([1]), discarded=np.array([False]))
    episodes.go_on(np.array([True, False, True]), spoiled=NONE, diverged=NONE)
    episodes.go_on(ALL, spoiled=NONE, diverged=NONE)

    assert episodes.over.tolist() == [True, False, True]
    assert episodes.elapsed.tolist() == [3, 1, 3]
    with pytest.raises(LQDError, match="expected envs 0, 2 to be reset after the end"):
        episodes.require_ready(AutoresetMode.DISABLED)
    episodes.require_ready(AutoresetMode.NEXT_STEP)


def test_without_a_limit_no_episode_is_over():
    episodes = Episodes.of(3, limit=None)
    episodes.start(np.arange(3), discarded=NONE)
    for _ in range(1000):
        episodes.go_on(ALL, spoiled=NONE, diverged=NONE)

    assert not episodes.over.any()
