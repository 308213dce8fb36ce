import mujoco
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from lqd_envs import SolutionError, Verdict, get_task, plan_motions
from lqd_envs.motion import (
    CLOSING_STEPS,
    HOLDING_STEPS,
    MOTION_STEPS,
    MOVING_STEPS,
    plan_in_scene,
    start_poses,
)
from lqd_envs.scenes.panda import GRIPPER_SITE

CLOSING = slice(0, 15)
MOVING = slice(15, 65)
HOLDING = slice(65, 75)

# High over the faucet, fingers down, 20 cm sideways and up: far from everything.
FREE = np.array([0.0, -0.8, 1.0, 0.0, 0.0, 0.0, 0.0, 0.6, 0.3])


@pytest.fixture(scope="module")
def plan(trajectories):
    return trajectories.plan


@pytest.fixture(scope="module")
def free(scene):
    plan = plan_in_scene(scene, FREE[None])
    assert plan.verdicts.tolist() == [Verdict.VALID]
    return plan


@pytest.fixture(scope="module")
def gripper_at(started):
    def position(arm):
        return started(arm).site(GRIPPER_SITE).xpos.copy()

    return position


def test_phases_last_as_documented():
    assert (CLOSING_STEPS, MOVING_STEPS, HOLDING_STEPS) == (15, 50, 10)
    assert MOTION_STEPS == 75


def test_shapes_and_types(plan, solutions):
    n = len(solutions)

    assert (plan.verdicts.shape, plan.verdicts.dtype) == ((n,), np.uint8)
    assert (plan.starts.shape, plan.starts.dtype) == ((n, 7), np.float64)
    assert (plan.actions.shape, plan.actions.dtype) == ((n, 75, 8), np.float32)
    assert np.abs(plan.actions).max() <= 1.0


def test_arm_holds_still_while_the_fingers_close(scene, plan):
    planned = plan.verdicts == Verdict.VALID
    arm = plan.actions[planned, CLOSING, :7]
    held = scene.action_map.controls(plan.actions[planned, 0])[:, :7]

    assert np.array_equal(arm, np.repeat(arm[:, :1], 15, axis=1))
    assert held == pytest.approx(plan.starts[planned], abs=1e-6)


def test_fingers_close_evenly_then_squeeze(plan):
    fingers = plan.actions[plan.verdicts == Verdict.VALID, :, 7]

    steps = np.diff(fingers[:, CLOSING], axis=1, prepend=1.0)
    assert steps == pytest.approx(np.full(steps.shape, -2.0 / 15.0), abs=1e-6)
    assert np.all(fingers[:, 14:] == -1.0)


def test_arm_moves_then_holds(plan):
    arm = plan.actions[plan.verdicts == Verdict.VALID, :, :7]

    assert np.all(np.abs(np.diff(arm[:, MOVING], axis=1)).max(axis=(1, 2)) > 0.0)
    assert np.array_equal(arm[:, HOLDING], np.repeat(arm[:, 64:65], 10, axis=1))


def test_targets_follow_the_line(scene, free, gripper_at):
    targets = scene.action_map.controls(free.actions[0])[:, :7]
    start = gripper_at(free.starts[0])
    line = 0.20 * FREE[6:9]

    share = np.array([(gripper_at(arm) - start) @ line / (line @ line) for arm in targets])
    aside = [gripper_at(arm) - start - s * line for arm, s in zip(targets, share, strict=True)]

    assert np.linalg.norm(aside, axis=1).max() < 1e-3
    assert share[CLOSING] == pytest.approx(np.zeros(15), abs=1e-4)
    # Minimum jerk: half way at half time, and the ends are slow.
    assert share[15 + 24] == pytest.approx(0.5, abs=5e-3)
    assert share[15 + 4] == pytest.approx(0.00856, abs=5e-3)
    assert share[HOLDING] == pytest.approx(np.ones(10), abs=5e-3)
    assert np.all(np.diff(share[MOVING]) > 0.0)


def test_gripper_gets_there(scene, free, started):
    data = started(free.starts[0])
    origin = data.site(GRIPPER_SITE).xpos.copy()

    for control in scene.action_map.controls(free.actions[0]):
        data.ctrl[:] = control
        mujoco.mj_step(scene.model, data, nstep=scene.substeps)

    moved = data.site(GRIPPER_SITE).xpos - origin
    assert moved == pytest.approx(0.20 * FREE[6:9], abs=5e-3)
    assert np.abs(data.qvel[scene.arm_qvel]).max() < 0.05


def test_rejected_motions_have_no_actions(plan):
    rejected = plan.verdicts != Verdict.VALID

    assert rejected.any()
    assert not plan.actions[rejected].any()
    assert not plan.starts[plan.verdicts == Verdict.UNREACHABLE].any()
    assert plan.starts[plan.verdicts == Verdict.OVERLAPPING].any(axis=1).all()


@pytest.mark.parametrize(
    ("solution", "verdict"),
    [
        (FREE, Verdict.VALID),
        # Fingers horizontal and towards the robot, from beyond the faucet.
        ([1, 0, -0.9, 0, np.pi / 2, 0, 0, 0, 0.5], Verdict.UNREACHABLE),
        # The palm inside the spout, the fingertips inside the pipe between the taps.
        ([0, 0, -0.5, 0, 0, 0, 0, 0, 0.5], Verdict.OVERLAPPING),
    ],
)
def test_verdicts_of_known_solutions(scene, solution, verdict):
    plan = plan_in_scene(scene, np.array([solution], dtype=np.float64))

    assert plan.verdicts.tolist() == [verdict]


def test_no_motion_is_simulated_from_inside_something(trajectories, started, robot_contacts):
    plan = trajectories.plan
    rows = np.flatnonzero(trajectories.simulated)
    assert len(rows)

    for i in rows:
        assert robot_contacts(started(plan.starts[i])) == []


def test_every_overlapping_start_is_inside_something(plan, started, robot_contacts):
    rows = np.flatnonzero(plan.verdicts == Verdict.OVERLAPPING)
    assert len(rows)

    for i in rows:
        assert any(contact.distance < 0.0 for contact in robot_contacts(started(plan.starts[i])))


@pytest.mark.parametrize("threads", [1, 2])
def test_plan_depends_neither_on_the_threads_nor_on_other_rows(scene, solutions, plan, threads):
    rows = np.arange(len(solutions))[40:10:-3]

    again = plan_in_scene(scene, solutions[rows], threads=threads)

    assert again.verdicts.tobytes() == plan.verdicts[rows].tobytes()
    assert again.starts.tobytes() == plan.starts[rows].tobytes()
    assert again.actions.tobytes() == plan.actions[rows].tobytes()


def test_empty_plan(scene):
    plan = plan_in_scene(scene, np.zeros((0, 9)))

    assert (plan.verdicts.shape, plan.starts.shape) == ((0,), (0, 7))
    assert plan.actions.shape == (0, 75, 8)


def test_start_poses_are_the_documented_ones(faucet):
    solution = np.array([[0.5, -1.0, 0.25, 0.3, -0.4, 1.0, 0.0, 0.0, 1.0]])

    positions, rotations = start_poses(faucet, solution)

    assert positions[0] == pytest.approx([0.55, -0.1, 0.165])
    x, y, z = (Rotation.from_rotvec(np.eye(3)[k] * solution[0, 3 + k]) for k in range(3))
    assert rotations[0].as_matrix() == pytest.approx((z * y * x).as_matrix())


def test_wrong_solutions_are_refused(scene):
    with pytest.raises(SolutionError, match=r"shape \(n, 9\), got \(9,\)"):
        plan_in_scene(scene, FREE)


@pytest.mark.parametrize("named", ["LQD/Faucet-v0", get_task("LQD/Faucet-v0")])
def test_motions_of_a_task_are_those_in_its_scene(named, free):
    plan = plan_motions(named, FREE[None])

    for one, other in zip(vars(plan).values(), vars(free).values(), strict=True):
        np.testing.assert_array_equal(one, other)
