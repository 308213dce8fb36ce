"""How infos look to the sandbox, which knows nothing of perception."""

from lqd_envs.perception import Columns
from lqd_llm.sandbox import InfoLayout


def perception_layout(columns: Columns) -> InfoLayout:
    """Return the layout of the infos that columns hold.

    Args:
        columns: The perception of some motions; its schema names links and joints.
    """
    schema = columns.schema
    names = {
        "gripper_contacts": schema.links,
        "joint_positions": [joint.name for joint in schema.joints],
    }
    return InfoLayout.of(columns.arrays(), names=names)
