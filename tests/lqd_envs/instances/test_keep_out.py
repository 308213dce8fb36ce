import itertools

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lqd_envs import PAPER_TASKS, get_task
from lqd_envs.instances import Instance, Obstacle, generate_instances
from lqd_envs.instances.keep_out import CLEARANCE, KeepOut
from lqd_envs.scene import load_scene
from lqd_envs.scenes.panda import HOME

UNIT = KeepOut(low=np.full((1, 3), -0.1), high=np.full((1, 3), 0.1))
BETWEEN = mujoco.MjModel.from_xml_string(
    """<mujoco><worldbody><geom type="box" size="0.1 0.1 0.1"/>
    <body><freejoint/><geom type="box" size="0.1 0.1 0.1"/></body></worldbody></mujoco>"""
)


def distance_to_unit(obstacle):
    """MuJoCo's distance of a box from the one that `UNIT` keeps free."""
    BETWEEN.geom_size[1] = obstacle.half_size
    data = mujoco.MjData(BETWEEN)
    data.qpos[:3] = obstacle.position
    data.qpos[3:] = (np.cos(obstacle.yaw / 2), 0.0, 0.0, np.sin(obstacle.yaw / 2))
    mujoco.mj_kinematics(BETWEEN, data)
    return mujoco.mj_geomDistance(BETWEEN, data, 0, 1, 10.0, None)


@settings(deadline=None, derandomize=True, max_examples=300)
@given(
    position=st.tuples(*[st.floats(-0.3, 0.3)] * 3),
    half_size=st.tuples(*[st.floats(0.01, 0.15)] * 3),
    yaw=st.floats(-3.1, 3.1),
)
def test_what_is_allowed_is_clear(position, half_size, yaw):
    obstacle = Obstacle(position, half_size, yaw)
    distance = distance_to_unit(obstacle)

    if UNIT.allows(obstacle):
        assert distance > CLEARANCE - 1e-4
    else:
        assert distance < CLEARANCE * np.sqrt(3) + 1e-4


def test_obstacles_keep_clear_of_one_another():
    first = Obstacle((1.0, 1.0, 0.1), (0.1, 0.1, 0.1), 0.5)
    more = UNIT.around(first)

    assert UNIT.allows(Obstacle((1.0, 1.1, 0.1), (0.05, 0.05, 0.1)))
    assert not more.allows(Obstacle((1.0, 1.1, 0.1), (0.05, 0.05, 0.1)))
    assert more.allows(Obstacle((1.0, 1.5, 0.1), (0.05, 0.05, 0.1)))
    assert not more.allows(Obstacle((0.0, 0.0, 0.1), (0.05, 0.05, 0.1)))


@pytest.mark.parametrize("task", PAPER_TASKS, ids=lambda task: task.name)
def test_drawn_obstacles_touch_neither_the_object_on_its_way_nor_the_arm_at_home(task):
    for instance in generate_instances(task, "obstacles", count=4, seed=11):
        assert_free(instance, task)


def assert_free(instance: Instance, task):
    scene = load_scene(instance.apply(get_task(task.id)))
    model, data = scene.model, mujoco.MjData(scene.model)
    boxes = model.body("obstacles").id
    data.qpos[:] = scene.start_qpos(HOME)
    joints = [(model.joint(j.name).qposadr[0], j.upper) for j in task.schema.joints]
    for shares in itertools.product(np.linspace(0.0, 1.0, 7), repeat=len(joints)):
        for (address, upper), share in zip(joints, shares, strict=True):
            data.qpos[address] = share * upper
        mujoco.mj_forward(model, data)
        bodies = model.geom_bodyid[data.contact.geom]
        assert not (bodies == boxes).any()
