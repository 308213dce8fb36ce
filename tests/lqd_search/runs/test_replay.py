import numpy as np
import pytest

from lqd_envs import RenderingError, SolutionSpace, rollout
from lqd_search.runs.replay import ReplayError, replay

TASK = "LQD/Faucet-v0"


@pytest.fixture(scope="module")
def motions():
    return rollout(TASK, SolutionSpace().sample(40, rng=np.random.default_rng(11)))


def test_a_replay_sees_what_the_batch_saw(motions):
    rows = np.flatnonzero(motions.valid)[:3]
    assert len(rows) == 3

    for row in rows:
        shown = replay(TASK, motions.solutions[row])

        assert shown.same_as_batch
        assert shown.infos == motions.infos(row)
        assert shown.digest == motions.digests()[row]
        assert shown.success == motions.success()[row]
        assert shown.frames == ()


def test_a_solution_that_is_rejected_cannot_be_replayed(motions):
    row = np.flatnonzero(~motions.simulated)[0]

    with pytest.raises(ReplayError, match="this one is rejected here"):
        replay(TASK, motions.solutions[row])


@pytest.mark.slow
def test_frames_are_collected_one_for_each_info(motions):
    row = np.flatnonzero(motions.valid)[0]
    try:
        shown = replay(TASK, motions.solutions[row], render_mode="rgb_array")
    except RenderingError as error:
        pytest.skip(str(error))

    assert len(shown.frames) == len(shown.infos) == 76
    assert shown.frames[0].shape == (480, 640, 3)
    assert (shown.frames[0] != shown.frames[-1]).any()
