"""Functions built from the source that a model wrote.

This runs the functions inside this process, in a minimal namespace: `math`, `np` and a few pure
builtins. That keeps honest code honest, but it is NOT a sandbox: code that means harm gets out of
it, and code that never ends is never stopped. Therefore only recorded replies are run this way:
those that ship with the package, which anybody can read, unless a caller names a directory of other
recordings and so vouches for them. A locked worker process replaces it in a later version.
"""

import ast
import builtins
import math
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from types import CodeType
from typing import Any

import numpy as np

from lqd_llm.errors import FunctionError
from lqd_llm.reply import FunctionSource

ENTRIES = {
    "success": "success",
    "fitness": "fitness",
    "timestamps": "timestamp",
    "quantities": "quantity",
}
"""What the functions of a kind are called in their code, whatever their own names."""

DIRECT_ENTRIES = ("success", "fitness", "descriptor")
"""The three functions of the kind `direct`, which are called the same as they are named."""

BUILTINS = (
    *("abs", "all", "any", "bool", "dict", "enumerate", "filter", "float", "frozenset", "int"),
    *("isinstance", "iter", "len", "list", "map", "max", "min", "next", "pow", "range"),
    *("reversed", "round", "set", "sorted", "str", "sum", "tuple", "zip"),
    *("ArithmeticError", "AssertionError", "AttributeError", "Exception", "IndexError"),
    *("KeyError", "LookupError", "OverflowError", "RuntimeError", "StopIteration"),
    *("TypeError", "ValueError", "ZeroDivisionError"),
)
"""The builtins that a function finds: pure ones, and the exceptions that calculations meet."""

FunctionCall = Callable[[Any], Any]
"""A function of `infos` or of one `info`; what it returns is for its caller to check."""


@dataclass(frozen=True)
class InferredFunction:
    """One function that a model wrote, ready to be called.

    Attributes:
        name: Its name, an identifier, distinct from the others of the same reply.
        description: What it measures, in the model's words.
        code: Its source, exactly as the model wrote it.
        entry: Name of the function in `code` that is called.
        call: That function, of one argument. It may raise anything.
    """

    name: str
    description: str
    code: str
    entry: str
    call: FunctionCall


class _FaultError(Exception):
    """What is wrong with a function, and in which line of its code."""

    def __init__(self, reason: str, *, line: int | None = None) -> None:
        super().__init__(f"line {line}: {reason}" if line else reason)


def build_function(source: FunctionSource, *, kind: str, entry: str) -> InferredFunction:
    """Build one function in a namespace that it shares with no other.

    Annotations are taken out first, so that a name such as `Info` need not exist.

    Args:
        source: The function as the model wrote it.
        kind: What the model was asked for, one of `lqd_llm.KINDS`; errors name it.
        entry: Name of the function in the code that is to be called.

    Raises:
        FunctionError: The code does not parse, imports something, lacks a top-level function
            `entry` that takes one positional argument, or raises while it is defined.
    """
    filename = f"<functional {source.name}>"
    try:
        tree, code = _compile(source.code, filename=filename)
        _check(tree, entry=entry)
        call = _define(code, entry=entry)
    except _FaultError as fault:
        raise FunctionError(
            f"The {kind} function {source.name!r} cannot be built: {fault}; "
            "correct its code or take another reply."
        ) from fault
    return InferredFunction(
        name=source.name,
        description=source.description,
        code=source.code,
        entry=entry,
        call=call,
    )


class _WithoutAnnotations(ast.NodeTransformer):
    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.AST:
        node.returns = None
        return self.generic_visit(node)

    def visit_arg(self, node: ast.arg) -> ast.AST:
        node.annotation = None
        return node

    def visit_AnnAssign(self, node: ast.AnnAssign) -> ast.AST:
        self.generic_visit(node)
        if node.value is None:
            return ast.copy_location(ast.Pass(), node)
        return ast.copy_location(ast.Assign(targets=[node.target], value=node.value), node)


def _compile(code: str, *, filename: str) -> tuple[ast.Module, CodeType]:
    try:
        tree = ast.parse(code, filename)
        _WithoutAnnotations().visit(tree)
        return tree, compile(tree, filename, "exec", dont_inherit=True)
    except SyntaxError as error:
        raise _FaultError(error.msg, line=error.lineno) from error
    # Python's answers to NUL or lone surrogate characters and to code that is nested too deeply.
    except (ValueError, RecursionError, MemoryError) as error:
        raise _FaultError(_words(error)) from error


def _check(tree: ast.Module, *, entry: str) -> None:
    for node in ast.walk(tree):
        if isinstance(node, ast.Import | ast.ImportFrom):
            raise _FaultError(
                "expected no import, since math and np are there already, "
                f"got '{ast.unparse(node)}'",
                line=node.lineno,
            )
    functions = {node.name: node for node in tree.body if isinstance(node, ast.FunctionDef)}
    if entry not in functions:
        raise _FaultError(
            f"expected a top-level function named {entry!r}, got {', '.join(functions) or 'none'}"
        )
    arguments = functions[entry].args
    positional = [*arguments.posonlyargs, *arguments.args]
    required = len(positional) - len(arguments.defaults)
    takes_one = bool(positional or arguments.vararg) and required <= 1
    if not takes_one or None in arguments.kw_defaults:
        raise _FaultError(
            f"expected {entry!r} to take one positional argument, "
            f"got {entry}({ast.unparse(arguments)})",
            line=functions[entry].lineno,
        )


def _define(code: CodeType, *, entry: str) -> FunctionCall:
    # A dictionary of its own, so that a function that rebinds a name does so for itself alone.
    namespace: dict[str, Any] = {
        "__builtins__": {name: getattr(builtins, name) for name in BUILTINS},
        "math": math,
        "np": np,
    }
    try:
        exec(code, namespace)  # noqa: S102
    # A model wrote this code: whatever it raises is a fault of the function, not of ours.
    except Exception as error:
        frames = traceback.extract_tb(error.__traceback__)
        lines = [frame.lineno for frame in frames if frame.filename == code.co_filename]
        raise _FaultError(
            f"{_words(error)}, while it was defined", line=lines[-1] if lines else None
        ) from error
    call: object = namespace.get(entry)
    if not callable(call):
        raise _FaultError(
            f"expected {entry!r} to be a function once the code has run, got {call!r}"
        )
    return call


def _words(error: BaseException) -> str:
    text = " ".join(str(error).split())
    return f"{type(error).__name__}: {text}" if text else type(error).__name__
