import numpy as np
import pytest

from lqd_envs import PAPER_TASKS, SolutionSpace, Trajectories
from lqd_search import ValuesError
from lqd_search.evaluation.contact import first_contacts, touched
from lqd_search.evaluation.expert_judge import ExpertJudge


@pytest.mark.parametrize("task", PAPER_TASKS, ids=lambda task: task.name)
def test_the_pose_is_that_of_the_first_moment_of_contact(task, motions_of):
    motions = motions_of(task.id)
    poses = first_contacts(motions)
    assert poses.shape == (len(motions), 6)
    assert not np.isnan(poses).all()
    assert np.isnan(poses).any()
    for i, pose in enumerate(poses):
        infos = motions.infos(i) if motions.valid[i] else []
        touching = [info for info in infos if any(info["gripper_contacts"].values())]
        if touching:
            metres = np.array(task.center) + 0.1 * pose[:3]
            assert metres == pytest.approx(np.array(touching[0]["gripper_position"]), abs=1e-12)
            assert pose[3:].tolist() == list(touching[0]["gripper_orientation"])
        else:
            assert np.isnan(pose).all()


def test_the_pose_lies_on_the_motion_in_the_units_of_its_start(faucet_motions):
    poses = first_contacts(faucet_motions)
    rows = np.flatnonzero(~np.isnan(poses[:, 0]))
    start, motion = faucet_motions.solutions[rows, :6], faucet_motions.solutions[rows, 6:]
    way = poses[rows, :3] - start[:, :3]
    along = (way * motion).sum(axis=1) / (motion**2).sum(axis=1)
    beside = np.linalg.norm(way - along[:, None] * motion, axis=1)
    # The arm's drives give way to what it touches, by millimetres to centimetres at most.
    assert np.median(beside) < 0.05
    # A motion of length 1 is 2 units of position long.
    assert along.max() < 2.1
    assert np.median(np.abs(poses[rows, 3:6] - start[:, 3:6])) < 0.05


def test_of_motions_that_failed_no_contact_is_kept(faucet_motions):
    nothing = np.full(len(faucet_motions), 1, np.uint8)
    failed = Trajectories(**vars(faucet_motions) | {"verdicts": nothing})
    assert not failed.valid.any()
    assert np.isnan(first_contacts(failed)).all()


def test_contacts_as_starts_are_in_the_space_after_repair(faucet_motions):
    poses = first_contacts(faucet_motions)
    poses = poses[~np.isnan(poses[:, 0])]
    space = SolutionSpace()
    starts = np.concatenate([poses, np.tile([0.0, 0.0, 1.0], (len(poses), 1))], axis=1)
    assert space.feasible(space.repair(starts)).all()


def test_values_without_contacts_cannot_say_who_touched_it(faucet_motions):
    values = ExpertJudge(faucet_motions.task)(faucet_motions)
    with pytest.raises(ValuesError, match="only none; evaluate with a MotionEvaluator"):
        touched(values)
