"""The infos of a vectorised environment: columns, with a mask beside each."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from lqd_envs.perception import Columns


def column_infos(
    columns: Columns,
    *,
    success: NDArray[np.bool_],
    discarded: NDArray[np.bool_],
    mask: NDArray[np.bool_],
) -> dict[str, Any]:
    """Return the last moments of the envs in the mask, and zeros for the others."""
    contacts, positions = columns.gripper_contacts[:, -1], columns.joint_positions[:, -1]
    joints = [joint.name for joint in columns.schema.joints]
    values = {
        "object_position": columns.object_position[:, -1],
        "object_orientation": columns.object_orientation[:, -1],
        "object_table_contact": columns.object_table_contact[:, -1],
        "robot_table_contact": columns.robot_table_contact[:, -1],
        "gripper_position": columns.gripper_position[:, -1],
        "gripper_orientation": columns.gripper_orientation[:, -1],
        "gripper_contacts": dict(zip(columns.schema.links, contacts.T, strict=True)),
        "joint_positions": dict(zip(joints, positions.T, strict=True)),
        "is_success": success,
        "discarded": discarded,
    }
    return _masked(values, mask)


def _masked(values: dict[str, Any], mask: NDArray[np.bool_]) -> dict[str, Any]:
    """Return the columns, zero outside the mask, with a mask of their own beside each."""
    infos: dict[str, Any] = {}
    for key, value in values.items():
        if isinstance(value, dict):
            infos[key] = _masked(value, mask)
        else:
            infos[key] = np.zeros(value.shape, value.dtype)
            infos[key][mask] = value[mask]
        infos[f"_{key}"] = mask.copy()
    return infos


def final_infos(
    observations: NDArray[np.float64], infos: dict[str, Any], *, mask: NDArray[np.bool_]
) -> dict[str, Any]:
    """Return what `SAME_STEP` tells of the episodes that ended, as Gymnasium nests it.

    Args:
        observations: (num_envs, d) last observations.
        infos: Last infos of the envs in the mask, as columns.
        mask: (num_envs,) whose episode ended.
    """
    final_obs = np.full(len(mask), None, dtype=object)
    for env in np.flatnonzero(mask):
        final_obs[env] = observations[env].copy()
    return {
        "final_obs": final_obs,
        "_final_obs": mask.copy(),
        "final_info": infos,
        "_final_info": mask.copy(),
    }
