"""How infos look to the sandbox, which knows nothing of perception."""

from typing import get_type_hints

from lqd_envs.perception import Info, PerceptionSchema, Vector3
from lqd_llm.sandbox import InfoLayout
from lqd_llm.sandbox.info_layout import InfoKey, InfoKind

_KINDS = {
    Vector3: InfoKind.VECTOR,
    bool: InfoKind.FLAG,
    dict[str, bool]: InfoKind.FLAGS,
    dict[str, float]: InfoKind.NUMBERS,
}


def perception_layout(schema: PerceptionSchema) -> InfoLayout:
    """Return how the sandbox makes infos of a task's columns.

    Args:
        schema: The task's perception schema, which names links and joints.
    """
    joints = tuple(joint.name for joint in schema.joints)
    names = {"gripper_contacts": schema.links, "joint_positions": joints}
    return InfoLayout(
        tuple(
            InfoKey(key, _KINDS[hint], names.get(key, ()))
            for key, hint in get_type_hints(Info).items()
        )
    )
