import dataclasses

import gymnasium as gym
import numpy as np
import pytest

from lqd_envs import ManipulationEnv, ResetError, get_task, rollout
from lqd_envs.instances import Instance, Obstacle
from lqd_search.report.rollouts import rollouts_of, stage_of
from lqd_search.report.scene_parts import FIXED, STEP

TASK = get_task("LQD/Faucet-v0")


def test_the_poses_are_those_of_the_motion(archive):
    elite = int(np.flatnonzero(archive.fields["expert"])[0])

    (shown,) = rollouts_of(TASK, archive, elites=np.array([elite]))

    stage = stage_of(TASK)
    poses = np.reshape(shown["poses"], (76, len(stage["bodies"]), 7)) * STEP
    assert shown["same"]
    assert shown["expert"]
    assert np.allclose(np.linalg.norm(poses[..., 3:], axis=2), 1.0, atol=3e-4)
    # The tap that the motion turned is the body whose angle about z ends as the run saw it.
    infos = rollout(TASK, archive.fields["solution"][[elite]]).infos(0)
    angles = 2.0 * np.arctan2(poses[-1, :, 6], poses[-1, :, 3])
    turned = infos[-1]["joint_positions"]["hot_tap"]
    assert turned > 0.314
    assert np.abs(np.abs(angles) - turned).min() < 1e-3
    assert np.abs(poses[0] - poses[-1]).max() > 0.03


def test_a_motion_that_differs_from_the_run_s_is_marked(archive):
    fields = archive.fields | {"digest": archive.fields["digest"] + np.uint64(1)}

    (shown,) = rollouts_of(TASK, dataclasses.replace(archive, fields=fields), elites=np.array([0]))

    assert not shown["same"]


def test_an_env_that_goes_another_way_than_the_batch_is_marked(archive, monkeypatch):
    step = ManipulationEnv.step
    monkeypatch.setattr(ManipulationEnv, "step", lambda env, action: step(env, 0.9 * action))
    (shown,) = rollouts_of(TASK, archive, elites=np.array([0]))

    assert not shown["same"]


def test_a_task_whose_usual_start_is_blocked_has_a_stage(monkeypatch):
    usual = stage_of(TASK)
    board = Obstacle((0.4, 0.0, 0.45), (0.2, 0.3, 0.02))
    blocked = gym.make(TASK.id, instance=Instance(TASK.id, obstacles=(board,)))
    with pytest.raises(ResetError, match="start"):
        blocked.reset()
    monkeypatch.setattr(gym, "make", lambda _: blocked)

    stage = stage_of(TASK)

    assert stage["bodies"] == usual["bodies"]
    assert len(stage["parts"]) == len(usual["parts"]) + 1


def test_a_motion_without_a_start_is_left_out(archive):
    solutions = archive.fields["solution"].copy()
    # Straight into the table.
    solutions[1, :6] = 0.0, 0.0, -1.0, 0.0, 0.0, 0.0
    fields = archive.fields | {"solution": solutions}
    changed = dataclasses.replace(archive, fields=fields)
    assert not rollout(TASK, solutions[[1]]).simulated[0]

    shown = rollouts_of(TASK, changed, elites=np.array([0, 1, 2]))

    assert [motion["elite"] for motion in shown] == [0, 2]


def test_a_stage_has_the_table_the_arm_and_the_object():
    stage = stage_of(TASK)

    bodies = {part["body"] for part in stage["parts"]}
    assert bodies == {FIXED, *stage["bodies"]}
    assert [0.78, 0.18, 0.16] in [part["color"] for part in stage["parts"]]
    for part in stage["parts"]:
        assert max(part["faces"]) == len(part["vertices"]) // 3 - 1
    assert sum(len(part["faces"]) for part in stage["parts"]) < 3 * 60_000
