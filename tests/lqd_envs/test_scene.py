import math

import mujoco
import numpy as np
import pytest

from lqd_envs import LQDError, get_task, rollout
from lqd_envs.scene import load_scene
from lqd_envs.scenes.faucet import TAP_RANGE, build_faucet_scene
from lqd_envs.scenes.panda import ARM_JOINTS, FINGER_JOINTS, HOME

TAPS = ("hot_tap", "cold_tap")
ONE_SECOND = 400


@pytest.fixture
def home(started):
    return started(HOME)


def run(scene, data, *, steps=ONE_SECOND):
    """Simulate while the arm holds still."""
    data.ctrl[:] = [*HOME, 0.04, 0.04]
    mujoco.mj_step(scene.model, data, nstep=steps)


def test_faucet_compiles():
    model = build_faucet_scene().compile()

    assert {model.body(i).name for i in range(model.nbody)} >= {"base", *TAPS, "gripper"}
    assert model.nu == 9


def test_scene_is_compiled_once(faucet, scene):
    assert load_scene(faucet) is scene


def test_control_step_is_a_whole_number_of_physics_steps(scene):
    assert scene.substeps * scene.model.opt.timestep == pytest.approx(0.02, abs=1e-15)


def test_physics_step_can_be_changed(faucet, scene):
    finer = load_scene(faucet, physics_step=1e-3)

    assert finer.model.opt.timestep == 1e-3
    assert finer.substeps == 20
    assert scene.model.opt.timestep == 0.0025


@pytest.mark.parametrize(("step", "substeps"), [(0.02 / 6, 6), (0.02, 1), (0.004, 5)])
def test_physics_step_divides_the_control_step(faucet, step, substeps):
    assert load_scene(faucet, physics_step=step).substeps == substeps


@pytest.mark.parametrize("step", [0.003, 0.0, -0.0025, 0.04, 0.0025001, float("nan"), float("inf")])
def test_physics_step_that_does_not_divide_the_control_step_is_refused(faucet, step):
    with pytest.raises(
        LQDError, match=r"that divides the control step of 20 ms, got .* ms: set the"
    ):
        load_scene(faucet, physics_step=step)


@pytest.mark.parametrize("tap", TAPS)
def test_range_of_the_taps(scene, tap):
    joint = scene.model.joint(tap)

    assert joint.range.tolist() == [0.0, TAP_RANGE]
    assert joint.range[1] == pytest.approx(2 * math.pi / 3)
    assert bool(joint.limited[0])


@pytest.mark.parametrize(("tap", "side"), [("hot_tap", 1.0), ("cold_tap", -1.0)])
def test_closed_lever_points_outwards_and_opens_towards_the_robot(scene, home, tap, side):
    axis, tip = home.body(tap).xpos.copy(), home.site(f"{tap}_tip").xpos.copy()
    assert axis == pytest.approx((0.5, 0.051 * side, 0.0))
    assert tip - axis == pytest.approx((0.0, 0.07 * side, 0.14))

    home.joint(tap).qpos[0] = math.pi / 2
    mujoco.mj_forward(scene.model, home)

    assert home.site(f"{tap}_tip").xpos - axis == pytest.approx((-0.07, 0.0, 0.14))


def test_task_s_centre_is_between_the_handles(faucet, home):
    handles = [home.body(tap).xpos[:2] for tap in TAPS]
    height = home.site("hot_tap_tip").xpos[2]

    assert faucet.center == pytest.approx((*np.mean(handles, axis=0), height))


def test_start_is_closed_open_fingered_and_still(home):
    assert [home.joint(tap).qpos[0] for tap in TAPS] == [0.0, 0.0]
    assert [home.joint(name).qpos[0] for name in ARM_JOINTS] == list(HOME)
    assert [home.joint(name).qpos[0] for name in FINGER_JOINTS] == [0.04, 0.04]
    assert not home.qvel.any()


def test_start_qpos_takes_any_number_of_arms(scene):
    arms = np.random.default_rng(0).uniform(-1.0, 1.0, (2, 3, 7))

    qpos = scene.start_qpos(arms)

    assert qpos.shape == (2, 3, scene.model.nq)
    assert np.array_equal(qpos[..., scene.arm_qpos], arms)
    assert np.array_equal(qpos[1, 2], scene.start_qpos(arms[1, 2]))


def test_fixed_objects_rest_where_they_were_built(scene):
    assert np.array_equal(scene.rest, scene.model.qpos0)


@pytest.mark.parametrize("task_id", ["LQD/Grasp-v0", "LQD/Push-v0"])
def test_free_object_rests_as_far_down_as_its_weight_presses_it(task_id):
    mug = load_scene(get_task(task_id))
    place = mug.model.joint("mug").qposadr[0]
    sunk = mug.rest - mug.model.qpos0

    assert np.flatnonzero(sunk).tolist() == [place + 2]
    assert -2e-4 < sunk[place + 2] < 0.0
    assert mug.start_qpos(np.zeros((5, 7)))[:, place : place + 7].tolist() == (
        [mug.rest[place : place + 7].tolist()] * 5
    )


def test_nothing_is_in_contact_at_the_start(home):
    assert home.ncon == 0


def test_robot_does_not_collide_with_itself(started, robot_contacts, trajectories):
    for start in trajectories.plan.starts[trajectories.plan.starts.any(axis=1)]:
        data = started(start)
        assert data.ncon == len(robot_contacts(data))


def test_closed_taps_stay_put(scene, home):
    run(scene, home)

    assert [home.joint(tap).qpos[0] for tap in TAPS] == pytest.approx([0.0, 0.0], abs=1e-6)
    assert home.ncon == 0


@pytest.mark.parametrize("tap", TAPS)
@pytest.mark.parametrize("angle", [0.3, 1.0, 2.0])
def test_friction_holds_an_open_tap(scene, home, tap, angle):
    home.joint(tap).qpos[0] = angle

    run(scene, home)

    assert home.joint(tap).qpos[0] == pytest.approx(angle, abs=1e-6)


@pytest.mark.parametrize("tap", TAPS)
@pytest.mark.parametrize(("torque", "turns"), [(0.05, False), (0.2, True)])
def test_friction_yields_to_more_than_its_torque(scene, home, tap, torque, turns):
    home.joint(tap).qfrc_applied[0] = torque

    run(scene, home)

    assert (home.joint(tap).qpos[0] > 0.1) == turns


@pytest.mark.parametrize("tap", TAPS)
def test_turning_tap_comes_to_rest_and_keeps_to_its_range(scene, home, tap):
    home.joint(tap).qvel[0] = 20.0

    run(scene, home)

    assert abs(home.joint(tap).qvel[0]) < 1e-3
    assert 0.1 < home.joint(tap).qpos[0] < TAP_RANGE + 0.01


@pytest.mark.parametrize("tap", TAPS)
@pytest.mark.parametrize(("torque", "end"), [(2.0, TAP_RANGE), (-2.0, 0.0)])
def test_stops_of_a_tap_are_hard(scene, home, tap, torque, end):
    home.joint(tap).qfrc_applied[0] = torque

    run(scene, home)

    assert home.joint(tap).qpos[0] == pytest.approx(end, abs=5e-3)


def test_arm_does_not_push_a_tap_past_its_end(faucet):
    pressed = rollout(faucet, [[0.72, -0.76, -0.19, -1.44, -0.34, 0.05, -0.36, -0.1, 0.09]])

    angles = pressed.columns.joint_positions[0, :, 0]
    assert pressed.valid.all()
    assert angles[-1] == pytest.approx(TAP_RANGE, abs=0.01)
    assert angles.min() > -0.01
    assert angles.max() < TAP_RANGE + 0.02


def test_one_tap_does_not_turn_the_other(scene, home):
    home.joint("hot_tap").qfrc_applied[0] = 0.3

    run(scene, home)

    assert home.joint("cold_tap").qpos[0] == pytest.approx(0.0, abs=1e-6)


def test_arm_holds_itself_still(scene, home):
    run(scene, home)

    assert home.qpos[scene.arm_qpos] == pytest.approx(HOME, abs=1e-3)


def test_fingers_close_in_the_time_of_a_motion(scene, home):
    targets = np.linspace(0.04, -0.02, 16)[1:]
    for target in targets:
        home.ctrl[:] = [*HOME, target, target]
        mujoco.mj_step(scene.model, home, nstep=scene.substeps)

    assert home.qpos[scene.finger_qpos] == pytest.approx([0.0, 0.0], abs=2e-3)
