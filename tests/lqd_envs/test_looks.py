import mujoco
import numpy as np
import pytest

from lqd_envs import TASKS, rollout
from lqd_envs.scene import load_scene
from lqd_envs.scenes.looks import without_looks
from lqd_envs.tasks.examples import example_solutions


@pytest.fixture(params=sorted(TASKS))
def scene(request):
    return load_scene(TASKS[request.param])


def test_what_can_be_touched_stays_and_what_is_only_seen_goes(scene):
    model, physics = scene.model, scene.physics
    touched = (model.geom_contype | model.geom_conaffinity) > 0

    assert physics.ngeom == touched.sum() < model.ngeom
    names = [model.geom(int(i)).name for i in np.flatnonzero(touched)]
    assert [physics.geom(i).name for i in range(physics.ngeom)] == names
    for field in ("type", "size", "friction", "solref", "solimp", "margin", "priority"):
        ours, theirs = (getattr(m, f"geom_{field}") for m in (model, physics))
        np.testing.assert_array_equal(ours[touched], theirs)


def test_bodies_joints_and_sensors_are_the_same_bits(scene):
    for field in (
        *("body_mass", "body_inertia", "body_ipos", "body_iquat", "body_pos", "body_quat"),
        *("body_gravcomp", "body_subtreemass", "dof_damping", "dof_armature", "dof_frictionloss"),
        *("dof_invweight0", "body_invweight0", "jnt_range", "jnt_solref", "qpos0", "site_pos"),
        *(
            "actuator_gainprm",
            "actuator_biasprm",
            "actuator_ctrlrange",
            "sensor_adr",
            "sensor_objid",
        ),
    ):
        ours, theirs = (getattr(m, field) for m in (scene.model, scene.physics))
        assert ours.tobytes() == theirs.tobytes(), field


def test_a_motion_is_the_same_bits_in_both(scene):
    solutions = example_solutions(scene.task)[-24:]
    trajectories = rollout(scene.task, solutions)
    row = int(np.flatnonzero(trajectories.valid)[0])
    data = mujoco.MjData(scene.model)
    data.qpos[:] = scene.start_qpos(trajectories.plan.starts[row])
    controls = scene.action_map.controls(trajectories.plan.actions[[row]])[0]
    positions = []
    for control in controls:
        data.ctrl[:] = control
        mujoco.mj_step(scene.model, data, nstep=scene.substeps)
        mujoco.mj_step1(scene.model, data)
        positions.append(
            scene.sensors.columns(data.sensordata[None, None]).gripper_position[0, 0].copy()
        )
    np.testing.assert_array_equal(
        trajectories.columns.gripper_position[row, 1:], np.array(positions)
    )


def test_bodies_need_no_names():
    spec = mujoco.MjSpec()
    parent = spec.worldbody.add_body(name="parent")
    parent.add_geom(size=(0.1, 0.0, 0.0))
    for mass in (1.0, 2.0):
        child = parent.add_body()
        child.add_joint(type=mujoco.mjtJoint.mjJNT_HINGE)
        child.add_geom(size=(0.1, 0.0, 0.0), mass=mass)
        child.add_geom(size=(0.2, 0.0, 0.0), mass=10.0 * mass, contype=0, conaffinity=0)
    model = spec.compile()

    physics = without_looks(spec, model)

    assert (model.ngeom, physics.ngeom) == (5, 3)
    for field in ("body_mass", "body_inertia", "body_ipos", "body_iquat"):
        assert getattr(physics, field).tobytes() == getattr(model, field).tobytes()
