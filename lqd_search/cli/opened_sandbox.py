"""The sandbox that a run's functionals are called in."""

from collections.abc import Iterable, Sequence
from typing import get_type_hints

from lqd_envs.perception import Info, PerceptionSchema, Vector3
from lqd_llm.recorded_code import is_recorded
from lqd_llm.sandbox import InfoLayout, Role, Sandbox, SandboxedFunction, check_source
from lqd_llm.sandbox.info_layout import InfoKey, InfoKind
from lqd_search.evaluation.direct_judge import DIRECT
from lqd_search.evaluation.values import StoppedFunction
from lqd_search.runs.function_text import DIRECT_KINDS, SINGLE_KINDS, FunctionText

_KINDS = {
    Vector3: InfoKind.VECTOR,
    bool: InfoKind.FLAG,
    dict[str, bool]: InfoKind.FLAGS,
    dict[str, float]: InfoKind.NUMBERS,
}


def info_layout(schema: PerceptionSchema) -> InfoLayout:
    """Return how the sandbox makes infos of a task's columns.

    Args:
        schema: The task's perception schema.
    """
    joints = tuple(joint.name for joint in schema.joints)
    names = {"gripper_contacts": schema.links, "joint_positions": joints}
    return InfoLayout(
        tuple(
            InfoKey(key, _KINDS[hint], names.get(key, ()))
            for key, hint in get_type_hints(Info).items()
        )
    )


def sandboxed(text: FunctionText) -> SandboxedFunction:
    """Check a functional's code, and return it as the sandbox takes it.

    Its role and name are the kind and the functional's name that a `Refusal` of it has.

    Raises:
        RejectedCodeError: The static check refuses the code.
    """
    single = DIRECT if text.kind in DIRECT_KINDS else text.entry
    return SandboxedFunction(
        single if text.kind in SINGLE_KINDS else text.name,
        Role(text.entry),
        check_source(text.code, entry=text.entry),
    )


def open_sandbox(
    schema: PerceptionSchema,
    functions: Sequence[FunctionText],
    *,
    stopped: Iterable[StoppedFunction] = (),
    allow_weak: bool = False,
) -> Sandbox | None:
    """Open a sandbox for functionals; whoever asks for it closes it.

    Args:
        schema: The perception schema of the functionals' task.
        functions: The functionals, those of a mesh or the three direct ones.
        stopped: Those that are not to be called.
        allow_weak: Whether code that does not ship with the package may run without the locks that
            this system does not have.

    Returns:
        The sandbox; None where there is nothing left to call.

    Raises:
        SandboxError: A function is refused, a lock is missing, or no worker starts.
    """
    without = {(one.kind, one.functional) for one in stopped}
    called = [
        function
        for function in map(sandboxed, functions)
        if (str(function.role), function.name) not in without
    ]
    if not called:
        return None
    # Code that ships with the package can be read by anybody, and was.
    recorded = all(is_recorded(text.code) for text in functions)
    return Sandbox(
        info_layout(schema), functions=called, allow_weak=allow_weak or recorded
    ).__enter__()
