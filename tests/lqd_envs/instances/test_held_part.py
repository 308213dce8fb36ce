from dataclasses import replace

import mujoco
import numpy as np
import pytest

from lqd_envs import get_task
from lqd_envs.instances import HeldPart, InstanceError
from lqd_envs.scene import load_scene

PARTS = ("handle", "rim", "body")


def held(columns):
    """The names of the parts that hold, one row each."""
    every = np.array([HeldPart(part).holds(columns) for part in PARTS])
    return [[PARTS[i] for i in np.flatnonzero(row)] for row in every.T]


def pad_contacts(scene, motions, row):
    """What each pad touches at the end: the handle, the inside or the outside of the wall."""
    model, data = scene.model, mujoco.MjData(scene.model)
    data.qpos[:] = scene.start_qpos(motions.plan.starts[row])
    mujoco.mj_forward(model, data)
    for action in motions.plan.actions[row]:
        data.ctrl[:] = scene.action_map.controls(action)
        mujoco.mj_step(model, data, nstep=scene.substeps)
    mujoco.mj_forward(model, data)
    mug = model.body("mug").id
    pads = {model.geom(name).id: set() for name in ("left_pad", "right_pad")}
    for contact in data.contact:
        for pad, other in (contact.geom, contact.geom[::-1]):
            if pad in pads and model.geom_bodyid[other] == mug:
                pads[pad].add(_place(model, data, other, contact.pos))
    return list(pads.values())


def _place(model, data, geom, position):
    if int(model.geom_type[geom]) == int(mujoco.mjtGeom.mjGEOM_CAPSULE):
        return "handle"
    # A wall is a box whose own x axis points outwards.
    outwards = data.geom_xmat[geom].reshape(3, 3)[:, 0] @ (position - data.geom_xpos[geom])
    return "outside" if outwards > 0.0 else "inside"


def test_each_of_the_motions_holds_one_part(solving):
    parts = held(solving("LQD/Grasp-v0").columns)

    assert parts == [["handle"]] * 3 + [["rim"]] * 3 + [["body"]] * 2


def test_it_is_the_part_that_the_pads_touch(solving):
    motions = solving("LQD/Grasp-v0")
    scene = load_scene(get_task("LQD/Grasp-v0"))
    for row, (part,) in enumerate(held(motions.columns)):
        left, right = pad_contacts(scene, motions, row)
        if part == "handle":
            assert "handle" in left
            assert "handle" in right
        elif part == "rim":
            assert {"inside", "outside"} <= left | right
        else:
            assert left == right == {"outside"}


def test_band_of_heights(solving):
    columns = solving("LQD/Grasp-v0").columns
    anywhere = HeldPart("rim").holds(columns)
    low, high = (
        HeldPart("rim", -0.05, 0.06).holds(columns),
        HeldPart("rim", 0.06, 0.15).holds(columns),
    )

    assert anywhere.tolist() == (low | high).tolist()
    assert not (low & high).any()


def test_turned_with_the_mug(solving):
    """The same grasp in a world that is turned about the vertical is the same grasp."""
    columns = solving("LQD/Grasp-v0").columns
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    quarter = np.array([0.0, 0.0, np.pi / 2])
    turned = replace(
        columns,
        object_position=columns.object_position @ turn.T,
        gripper_position=columns.gripper_position @ turn.T,
        object_orientation=columns.object_orientation + quarter,
        gripper_orientation=columns.gripper_orientation + quarter,
    )

    assert held(turned) == held(columns)


def test_no_motions(solving):
    columns = solving("LQD/Grasp-v0").columns.rows(np.arange(0))

    assert HeldPart("rim").holds(columns).shape == (0,)


def test_errors():
    with pytest.raises(InstanceError, match="'lid'; choose one of handle, rim, body"):
        HeldPart("lid")
    with pytest.raises(InstanceError, match="`low` below `high`"):
        HeldPart("rim", 0.05, 0.04)
    with pytest.raises(InstanceError, match="a task with the mug, but got LQD/Faucet-v0"):
        HeldPart("rim").require_fits(get_task("LQD/Faucet-v0"))
