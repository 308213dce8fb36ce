"""The contact booleans against MuJoCo's own list of contacts, at 1,000 random states a task."""

import mujoco
import numpy as np
import pytest

from lqd_envs import TASKS, ManipulationEnv
from lqd_envs.scene import load_scene
from lqd_envs.scenes.panda import ARM_JOINTS, FINGER_OPEN

STATES = 1000
MOVING = 500
GRIPPER_BODIES = {"gripper", "left_finger", "right_finger"}

IDS = sorted(task_id for task_id in TASKS if task_id.startswith("LQD/"))


def below(model, root):
    """Names of a body and of all bodies that hang on it."""
    names = set()
    for i in range(model.nbody):
        body = i
        while body and model.body(body).name != root:
            body = model.body_parentid[body]
        if model.body(body).name == root:
            names.add(model.body(i).name)
    return names


def touching_pairs(model, data):
    """The pairs of what touches: names of bodies, and `table` for the geom of that name."""
    pairs = set()
    for contact in data.contact:
        names = [
            "table"
            if model.geom(geom).name == "table"
            else model.body(model.geom_bodyid[geom]).name
            for geom in contact.geom
        ]
        pairs |= {tuple(names), tuple(reversed(names))}
    return pairs


def flags_by_hand(task, model, data):
    """The contact booleans of an info, from `data.contact` alone."""
    pairs = touching_pairs(model, data)
    on_table = {body for body, other in pairs if other == "table"}
    return {
        "object_table_contact": task.schema.fixed or bool(on_table & below(model, task.base)),
        "robot_table_contact": bool(on_table & below(model, "panda0_link0")),
        "gripper_contacts": {
            link: any((body, link) in pairs for body in GRIPPER_BODIES)
            for link in task.schema.links
        },
    }


def flags_of(info):
    return {
        key: info[key]
        for key in ("object_table_contact", "robot_table_contact", "gripper_contacts")
    }


def states_of_motions(env, trajectories, rng):
    """Yield (info, data) at random moments of random valid motions, half of them touching."""
    touched = trajectories.columns.gripper_contacts.any(axis=(1, 2))
    rows = np.concatenate(
        [
            rng.permutation(np.flatnonzero(trajectories.valid & side))[:10]
            for side in (touched, ~touched)
        ]
    )
    chosen = rng.permutation(len(rows) * 75)[:MOVING]
    for place, row in enumerate(rows):
        env.reset(options={"arm": trajectories.plan.starts[row]})
        for moment, action in enumerate(trajectories.plan.actions[row]):
            info = env.step(action)[4]
            if place * 75 + moment in chosen:
                yield info, env.data


def put_object(task, data, rng):
    """Put the object's joints, or the free object itself, anywhere."""
    if task.schema.joints:
        for joint in task.schema.joints:
            data.joint(joint.name).qpos[0] = rng.uniform(0.0, joint.upper)
    if not task.schema.fixed:
        quaternion = rng.standard_normal(4)
        place = np.add(task.center, rng.uniform(-0.1, 0.1, 3))
        data.joint(task.base).qpos[:] = [*place, *quaternion / np.linalg.norm(quaternion)]


def states_at_random(task, trajectories, rng):
    """Yield (info, data): starts of the arm near the object, or anywhere, and the object anyhow."""
    scene = load_scene(task)
    model, data = scene.model, mujoco.MjData(scene.model)
    limits = [model.joint(name).range for name in ARM_JOINTS]
    starts = trajectories.plan.starts[trajectories.plan.starts.any(axis=1)]
    for k in range(STATES - MOVING):
        mujoco.mj_resetData(model, data)
        arm = rng.uniform(*np.transpose(limits)) if k % 4 == 0 else rng.choice(starts)
        data.qpos[:] = scene.start_qpos(arm)
        data.qpos[scene.finger_qpos] = rng.uniform(0.0, FINGER_OPEN, 2)
        put_object(task, data, rng)
        mujoco.mj_forward(model, data)
        yield scene.sensors.columns(data.sensordata[None, None]).infos(0)[0], data


@pytest.mark.parametrize("task_id", IDS)
def test_booleans_agree_with_the_contact_list_at_1000_states(motions_of, task_id):
    task, trajectories, rng = TASKS[task_id], motions_of(task_id), np.random.default_rng(12)
    env = ManipulationEnv(task_id)
    seen = []
    for states in (
        states_of_motions(env, trajectories, rng),
        states_at_random(task, trajectories, rng),
    ):
        for info, data in states:
            flags = flags_of(info)
            assert flags == flags_by_hand(task, env.model, data)
            seen.append(flags)

    assert len(seen) == STATES
    # Each of them is seen true and false.
    assert {flags["robot_table_contact"] for flags in seen} == {True, False}
    for link in task.schema.links:
        assert 10 < sum(flags["gripper_contacts"][link] for flags in seen) < STATES - 10
    on_table = sum(flags["object_table_contact"] for flags in seen)
    assert on_table == STATES if task.schema.fixed else 10 < on_table < STATES - 10


@pytest.mark.parametrize("task_id", IDS)
def test_every_listed_contact_is_one(task_id):
    model = load_scene(TASKS[task_id]).model

    # With a margin or a gap, the list would hold pairs that do not touch.
    assert not model.geom_margin.any()
    assert not model.geom_gap.any()
