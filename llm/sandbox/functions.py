"""The functions that a sandbox is given."""

from collections.abc import Sequence
from dataclasses import dataclass

from lqd_llm.sandbox.errors import SandboxError
from lqd_llm.sandbox.roles import Role
from lqd_llm.sandbox.static_check import CheckedSource
from lqd_llm.sandbox.wire import NO_FUNCTION


@dataclass(frozen=True)
class SandboxedFunction:
    """One function to run in a sandbox.

    Attributes:
        name: Its name, distinct from the others of its role.
        role: What it is given, and what it must return.
        source: Its code, which passed the static check.
    """

    name: str
    role: Role
    source: CheckedSource


def check_functions(functions: Sequence[SandboxedFunction]) -> None:
    """Check that functions can be told apart.

    Raises:
        SandboxError: There are none or too many, or two of a role have the same name.
    """
    if not 0 < len(functions) < NO_FUNCTION:
        raise SandboxError(f"Expected 1 to {NO_FUNCTION - 1} functions, but got {len(functions)}.")
    named = [(function.role, function.name) for function in functions]
    for role, name in named:
        if named.count((role, name)) > 1:
            raise SandboxError(
                f"Expected functions of different names in each role, but two of the role {role} "
                f"are called {name!r}; rename one."
            )
