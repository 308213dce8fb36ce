"""Whether the obstacles of a scene leave the object alone."""

import mujoco
import numpy as np

from lqd_envs.instances.instance_error import InstanceError
from lqd_envs.scenes.sensors import OBSTACLES


def require_object_clear(model: mujoco.MjModel, *, base: str) -> None:
    """Raise `InstanceError` where an obstacle touches the object at the start.

    The solver would throw the object out of it, which looks like a motion. A part that is fixed to
    the table stays where it is, and may stand in an obstacle.

    Args:
        model: The compiled scene, with obstacles.
        base: Body whose frame is the object's base.
    """
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    obstacles, root = model.body(OBSTACLES).id, model.body_rootid[model.body(base).id]
    depths: dict[int, float] = {}
    for contact in data.contact:
        bodies = model.geom_bodyid[contact.geom]
        if obstacles in bodies and root in model.body_rootid[bodies]:
            box = int(contact.geom[np.flatnonzero(bodies == obstacles)[0]])
            number = box - int(model.body_geomadr[obstacles])
            depths[number] = max(depths.get(number, 0.0), -float(contact.dist))
    if depths:
        deepest = max(depths, key=lambda number: depths[number])
        raise InstanceError(
            "Expected obstacles that do not touch the object at the start, but got "
            f"obstacles[{deepest}], which is {1e3 * depths[deepest]:.1f} mm inside it; move it "
            "away, or make it smaller."
        )
