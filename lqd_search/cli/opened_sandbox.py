"""The sandbox that a run's functionals are called in."""

from collections.abc import Iterable, Sequence

from lqd_envs.perception import PerceptionSchema
from lqd_llm import perception_layout
from lqd_llm.recorded_code import is_recorded
from lqd_llm.sandbox import Role, Sandbox, SandboxedFunction, check_source
from lqd_search.evaluation.direct_judge import DIRECT
from lqd_search.evaluation.values import StoppedFunction
from lqd_search.runs.function_text import DIRECT_KINDS, SINGLE_KINDS, FunctionText


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
        perception_layout(schema), functions=called, allow_weak=allow_weak or recorded
    ).__enter__()
