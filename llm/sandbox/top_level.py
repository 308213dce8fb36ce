"""What stands at the top level of code: functions, constants, and the entry among them.

Constants may not hold anything that would remember a call, as far as that can be seen here.
"""

import ast
from collections.abc import Iterator

from lqd_llm.sandbox.allowlist import BUILTINS, MUTATORS
from lqd_llm.sandbox.errors import RejectedCodeError
from lqd_llm.sandbox.names import Names, own_nodes

_ITERATORS = frozenset({"enumerate", "filter", "map", "reversed", "zip"})
_CALLED_AT_ONCE = frozenset(BUILTINS) - {"iter", "next"}
_LONGEST_SIGNATURE = 100


def check_top_level(tree: ast.Module, names: Names) -> None:
    """Check that the code at the top level defines functions and constants, and does nothing else.

    Raises:
        RejectedCodeError: It does.
    """
    for statement in tree.body:
        match statement:
            case ast.FunctionDef() | ast.Pass() | ast.Expr(value=ast.Constant()):
                continue
            case ast.Assign(targets=targets, value=value) if all(map(_is_plain, targets)):
                _check_constant(value, names)
            case _:
                raise RejectedCodeError(
                    "only functions and constants can stand at the top level",
                    line=statement.lineno,
                )


def check_entry(tree: ast.Module, names: Names, *, entry: str) -> None:
    """Check that there is one function of that name, and that it takes one positional argument.

    Raises:
        RejectedCodeError: There is none, it is bound twice, it is a generator or takes something
            else.
    """
    functions = [node for node in tree.body if isinstance(node, ast.FunctionDef)]
    found = [node for node in functions if node.name == entry]
    if not found:
        there = ", ".join(node.name for node in functions)[:_LONGEST_SIGNATURE]
        raise RejectedCodeError(
            f"there must be a function {entry!r} at the top level, but there is {there or 'none'}"
        )
    line = found[-1].lineno
    if len(found) > 1 or entry in names.assigned:
        raise RejectedCodeError(f"{entry!r} is bound more than once", line=line)
    arguments = found[0].args
    positional = [*arguments.posonlyargs, *arguments.args]
    required = len(positional) - len(arguments.defaults)
    takes_one = bool(positional or arguments.vararg) and required <= 1
    if not takes_one or None in arguments.kw_defaults:
        signature = f"{entry}({ast.unparse(arguments)})"[:_LONGEST_SIGNATURE]
        raise RejectedCodeError(f"{signature} does not take one positional argument", line=line)
    if any(isinstance(node, ast.Yield | ast.YieldFrom) for node in own_nodes(found[0])):
        raise RejectedCodeError(f"{entry!r} must return its value, not yield it", line=line)


def _is_plain(target: ast.expr) -> bool:
    match target:
        case ast.Tuple(elts=elements) | ast.List(elts=elements):
            return all(map(_is_plain, elements))
        case _:
            return isinstance(target, ast.Name)


def _check_constant(value: ast.expr, names: Names) -> None:
    used_up: set[ast.expr] = set()
    for node in _run_at_once(value):
        match node:
            case ast.Call(args=arguments):
                _check_call(node, names)
                used_up.update(arguments)
            case ast.comprehension():
                used_up.add(node.iter)
    for node in _run_at_once(value):
        if _is_iterator(node) and node not in used_up:
            raise RejectedCodeError(
                "an iterator at the top level would be used up by the first call; make it a tuple",
                line=value.lineno,
            )


def _check_call(call: ast.Call, names: Names) -> None:
    match call.func:
        case ast.Name(id=name) if name in _CALLED_AT_ONCE and name not in names.bound:
            return
        case ast.Attribute(attr=name) if name not in MUTATORS or names.facade_of(call.func.value):
            return
    raise RejectedCodeError(
        f"{ast.unparse(call.func)[:_LONGEST_SIGNATURE]!r} cannot be called at the top level; "
        "call it within the function",
        line=call.lineno,
    )


def _is_iterator(node: ast.AST) -> bool:
    match node:
        case ast.GeneratorExp():
            return True
        case ast.Call(func=ast.Name(id=name)):
            return name in _ITERATORS
        case _:
            return False


def _run_at_once(node: ast.AST) -> Iterator[ast.AST]:
    """Yield what runs when an expression does: all of it but the bodies of lambdas."""
    yield node
    if isinstance(node, ast.Lambda):
        yield from _run_at_once(node.args)
        return
    for child in ast.iter_child_nodes(node):
        yield from _run_at_once(child)
