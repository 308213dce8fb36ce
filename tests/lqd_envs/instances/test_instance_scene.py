"""What is simulated in an instance: solid boxes, and a changed object."""

import math
from dataclasses import replace

import mujoco
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from lqd_envs import Verdict, get_task, rollout
from lqd_envs.instances import Instance, Obstacle, SceneChange, generate_instances
from lqd_envs.motion import overlaps
from lqd_envs.scene import load_scene
from lqd_envs.scenes.panda import HOME
from lqd_envs.scenes.sensors import OBSTACLES

FAUCET, GRASP, DRAWER, PUSH = "LQD/Faucet-v0", "LQD/Grasp-v0", "LQD/Drawer-v0", "LQD/Push-v0"
FAR_BOX = Obstacle((-0.3, 0.5, 0.05), (0.02, 0.02, 0.05))


def scene_with(task_id, *obstacles, change=None):
    task = get_task(task_id)
    return load_scene(Instance(task_id, obstacles=obstacles, change=change).apply(task))


def at_home(scene):
    data = mujoco.MjData(scene.model)
    data.qpos[:] = scene.start_qpos(HOME)
    data.ctrl[:] = [*HOME, 0.04, 0.04]
    mujoco.mj_forward(scene.model, data)
    return data


@pytest.mark.parametrize("link", [*range(2, 8)])
def test_every_link_of_the_arm_meets_an_obstacle(link):
    data = at_home(load_scene(get_task(FAUCET)))
    place = data.body(f"panda0_link{link}").xipos
    scene = scene_with(FAUCET, Obstacle(place.tolist(), (0.005, 0.005, 0.005)))

    assert overlaps(scene, np.array([HOME])).all()
    assert not overlaps(scene_with(FAUCET, FAR_BOX), np.array([HOME])).any()


def test_obstacles_out_of_reach_change_no_bit(solving):
    motions = solving(PUSH)
    again = rollout(Instance(PUSH, obstacles=[FAR_BOX]).apply(motions.task), motions.solutions)

    assert again.digests().tolist() == motions.digests().tolist()
    assert again.verdicts.tolist() == motions.verdicts.tolist()
    assert again.obstructed.tolist() == [False] * len(motions)
    assert motions.obstructed is None


@pytest.mark.parametrize("yaw", [0.0, math.pi / 4])
def test_mug_that_slides_is_stopped_by_a_box(yaw):
    # Turned by 45 degrees, a vertical edge meets the mug between the bumpers of its wall.
    front = 0.62
    half = 0.02 * (math.cos(yaw) + math.sin(yaw))
    scene = scene_with(PUSH, Obstacle((front + half, 0.0, 0.05), (0.02, 0.02, 0.05), yaw))
    data, free = at_home(scene), at_home(load_scene(get_task(PUSH)))
    for some, model in ((data, scene.model), (free, load_scene(get_task(PUSH)).model)):
        some.joint("mug").qvel[0] = 1.2
        mujoco.mj_step(model, some, nstep=400)

    assert free.body("mug").xpos[0] > front
    assert data.body("mug").xpos[0] < front - 0.03


def test_drawer_is_stopped_by_a_box():
    scene = scene_with(DRAWER, Obstacle((0.40, 0.0, 0.1), (0.03, 0.05, 0.1)))
    data = at_home(scene)
    data.joint("drawer").qvel[0] = 1.0
    mujoco.mj_step(scene.model, data, nstep=400)

    # Its handle's bar, 6 mm thick, is 12 cm before the closed front.
    assert 0.05 < data.joint("drawer").qpos[0] < 0.55 - 0.045 - 0.43
    assert scene.sensors.depth(data.sensordata) < 0.003


def test_start_inside_an_obstacle_is_rejected(solving):
    motions = solving(FAUCET)
    scene = load_scene(motions.task)
    data = mujoco.MjData(scene.model)
    data.qpos[:] = scene.start_qpos(motions.plan.starts[0])
    mujoco.mj_forward(scene.model, data)
    box = Obstacle(data.body("gripper").xpos.tolist(), (0.02, 0.02, 0.02))
    again = rollout(Instance(FAUCET, obstacles=[box]).apply(motions.task), motions.solutions[:1])

    assert again.verdicts.tolist() == [Verdict.OVERLAPPING]
    assert again.success().tolist() == [False]


def test_motion_that_touches_an_obstacle_is_no_success(solving):
    motions = solving(FAUCET)
    instance = generate_instances(FAUCET, "obstacles", count=1, seed=0)[0]
    again = rollout(instance.apply(motions.task), motions.solutions)
    expert = motions.task.success(again.columns) & again.valid

    assert (expert & again.obstructed).any()
    assert (expert & ~again.obstructed).any()
    assert again.success().tolist() == (expert & ~again.obstructed).tolist()
    kept = again.rows(np.flatnonzero(again.obstructed))
    assert kept.obstructed.all()
    assert not kept.success().any()


@pytest.mark.parametrize("task_id", [FAUCET, GRASP, DRAWER, PUSH])
def test_object_is_moved_and_turned_about_the_centre(task_id):
    task = get_task(task_id)
    change = SceneChange(shift=(0.02, -0.01), turn=0.3)
    before, after = at_home(load_scene(task)), at_home(scene_with(task_id, change=change))
    center, turn = np.array(task.center), Rotation.from_euler("z", 0.3)
    for name in (*task.schema.links, task.base):
        old, new = before.body(name), after.body(name)
        expected = center + turn.apply(old.xpos - center) + (0.02, -0.01, 0.0)
        np.testing.assert_allclose(new.xpos, expected, atol=1e-9)
        expected = turn.as_matrix() @ old.xmat.reshape(3, 3)
        np.testing.assert_allclose(new.xmat.reshape(3, 3), expected, atol=1e-9)
    info = load_scene(task).sensors.columns(after.sensordata[None, None]).infos(0)[0]
    assert info["object_orientation"] == pytest.approx((0.0, 0.0, 0.3), abs=1e-9)


@pytest.mark.parametrize("task_id", [FAUCET, DRAWER, GRASP])
def test_what_is_scaled(task_id):
    task = get_task(task_id)
    change = SceneChange(contact_friction=0.5, joint_friction=2.0, damping=1.5, mass=1.25)
    old, new = load_scene(task).model, scene_with(task_id, change=change).model
    root = old.body_rootid == old.body(task.base).id
    dofs = root[old.dof_bodyid]

    np.testing.assert_allclose(new.geom_friction, 0.5 * old.geom_friction)
    for attribute, scale in (("body_mass", 1.25), ("body_inertia", 1.25)):
        some, other = getattr(old, attribute), getattr(new, attribute)
        np.testing.assert_allclose(other[root], scale * some[root], rtol=1e-9)
        np.testing.assert_array_equal(other[~root], some[~root])
    for attribute, scale in (("dof_frictionloss", 2.0), ("dof_damping", 1.5)):
        some, other = getattr(old, attribute), getattr(new, attribute)
        np.testing.assert_allclose(other[dofs], scale * some[dofs])
        np.testing.assert_array_equal(other[~dofs], some[~dofs])
    np.testing.assert_array_equal(new.dof_armature, old.dof_armature)


def test_friction_of_obstacles_is_scaled_with_all_others():
    change = SceneChange(contact_friction=0.5, mass=2.0)
    plain, new = (scene_with(PUSH, FAR_BOX, change=some).model for some in (None, change))
    box = int(plain.body(OBSTACLES).geomadr[0])

    assert plain.geom_friction[box, 0] == 0.5
    np.testing.assert_allclose(new.geom_friction, 0.5 * plain.geom_friction)
    assert new.body(OBSTACLES).mass == plain.body(OBSTACLES).mass


def test_solutions_stay_relative_to_the_task_s_own_centre(solving):
    motions = solving(PUSH)
    moved = Instance(PUSH, change=SceneChange(shift=(0.0, 0.02)))
    again = rollout(moved.apply(motions.task), motions.solutions)
    valid = again.valid

    assert valid.any()
    np.testing.assert_array_equal(again.plan.starts[valid], motions.plan.starts[valid])
    np.testing.assert_array_equal(again.plan.actions[valid], motions.plan.actions[valid])
    assert again.columns.object_position[valid, 0, 1] == pytest.approx(0.02)


@pytest.mark.parametrize("task_id", [FAUCET, DRAWER])
def test_nearness_is_that_to_the_moved_object(solving, task_id):
    task, columns = get_task(task_id), solving(task_id).columns
    change = SceneChange(shift=(0.02, -0.03), turn=0.2)
    varied = Instance(task_id, change=change).apply(task)
    center, turn = np.array(task.center), Rotation.from_euler("z", 0.2).as_matrix()

    def moved(positions):
        return (positions - center) @ turn.T + center + (0.02, -0.03, 0.0)

    with_it = replace(
        columns,
        gripper_position=moved(columns.gripper_position),
        object_position=moved(columns.object_position),
    )
    np.testing.assert_allclose(varied.nearness(with_it), task.nearness(columns), atol=1e-12)
    assert np.abs(varied.nearness(columns) - task.nearness(columns)).max() > 1e-3
