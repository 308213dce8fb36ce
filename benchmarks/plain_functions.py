"""Functionals called in this process, as plain Python: what the sandbox is compared with.

Nothing here keeps them from doing harm or from never ending. It is only for code that one has read,
such as that of the recordings that ship with the package; any other belongs in `lqd_llm.sandbox`.
"""

import __future__

import math
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from lqd_envs import LQDError
from lqd_search import DirectFunctionals, Functionals
from lqd_search.runs.function_text import DIRECT_KINDS, FunctionText


def plain_function(code: str, *, entry: str) -> Callable[[Any], Any]:
    """Run code in a namespace of its own, which has `math` and `np`, and return its function.

    Args:
        code: Code that somebody has read.
        entry: Name of the function in the code.

    Raises:
        LQDError: The code has no such function.
    """
    namespace: dict[str, Any] = {"math": math, "np": np}
    # A name that only an annotation has, such as `Info`, need not exist.
    flags = __future__.annotations.compiler_flag
    exec(compile(code, f"<{entry}>", "exec", flags, dont_inherit=True), namespace)  # noqa: S102
    function: object = namespace.get(entry)
    if not callable(function):
        raise LQDError(
            f"Expected code that defines a function {entry!r}, but it does not; correct the code."
        )
    return function


def plain_functionals(texts: Iterable[FunctionText]) -> Functionals:
    """Return the functionals of a mesh, to be called in this process.

    Args:
        texts: Their code, which somebody has read; direct ones are left out.
    """
    calls: dict[str, dict[str, Callable[[Any], Any]]] = {
        kind: {} for kind in ("success", "fitness", "timestamp", "quantity")
    }
    for text in texts:
        if text.kind not in DIRECT_KINDS:
            calls[text.kind][text.name] = plain_function(text.code, entry=text.entry)
    (success,) = calls["success"].values()
    return Functionals(
        success=success,
        fitness=calls["fitness"],
        timestamps=calls["timestamp"],
        quantities=calls["quantity"],
    )


def plain_direct_functionals(texts: Iterable[FunctionText]) -> DirectFunctionals:
    """Return the three functions that a model writes at once, to be called in this process.

    Args:
        texts: Their code, which somebody has read; those of a mesh are left out.
    """
    return DirectFunctionals(
        **{
            text.entry: plain_function(text.code, entry=text.entry)
            for text in texts
            if text.kind in DIRECT_KINDS
        }
    )
