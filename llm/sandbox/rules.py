"""The rules for each kind of syntax that the allowlist has."""

import ast
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from difflib import get_close_matches
from typing import Any

from lqd_llm.sandbox.allowlist import (
    BUILTINS,
    EXCEPTIONS,
    FACADE_NAMES,
    LARGEST_INTEGER,
    LONGEST_NAME,
    MUTATORS,
    VALUE_ATTRIBUTES,
)
from lqd_llm.sandbox.call_rules import (
    EXPECTED_DTYPE,
    TYPED,
    check_call,
    is_dtype,
    is_plain_call,
)
from lqd_llm.sandbox.errors import RejectedCodeError
from lqd_llm.sandbox.names import Names, own_nodes, root_of

_AVAILABLE = frozenset(BUILTINS)
_FACADES = frozenset(name for name in FACADE_NAMES if "." not in name)
_PLAIN_FORMAT = re.compile(r"(?:.?[<>=^])?[-+ ]?z?#?0?\d{0,2}[,_]?(?:\.\d{1,2})?[a-zA-Z%]?")
_TYPE_KEYWORDS = frozenset({"casting", "like", "sig", "signature"})
_PLAIN_DEFAULT = (
    *(ast.Constant, ast.Name, ast.Attribute, ast.Tuple, ast.UnaryOp, ast.BinOp),
    *(ast.operator, ast.unaryop, ast.expr_context),
)


def check_rules(tree: ast.Module, names: Names) -> None:
    """Check names, attributes and what else the kind of a node does not tell.

    Args:
        tree: A syntax tree of allowed nodes, so flat that it can be walked recursively.
        names: Its names.

    Raises:
        RejectedCodeError: A rule is broken; the first in the order of the text is said.
    """
    typed: set[ast.AST] = set()
    for node in _in_order(tree):
        if isinstance(node, ast.Call) and is_plain_call(node, names):
            typed.add(node.func)
        if isinstance(node, ast.Attribute) and node.attr in TYPED and node not in typed:
            raise RejectedCodeError(TYPED[node.attr], line=node.lineno)
        if rule := _RULES.get(type(node)):
            rule(node, names)


def _in_order(node: ast.AST) -> Iterator[ast.AST]:
    # Of `a.b.c`, the first part that is not allowed tells most.
    last = isinstance(node, ast.Attribute)
    if not last:
        yield node
    for child in ast.iter_child_nodes(node):
        yield from _in_order(child)
    if last:
        yield node


def _check_identifier(name: str, *, line: int) -> None:
    if not name.isascii() or len(name) > LONGEST_NAME:
        raise RejectedCodeError(
            f"the name {name[:LONGEST_NAME]!r} is not plain ASCII or too long", line=line
        )
    if "__" in name:
        raise RejectedCodeError(
            f"the name {name!r} is not allowed: it has two underscores in a row", line=line
        )


def _check_binding(name: str, *, line: int) -> None:
    _check_identifier(name, line=line)
    if name in _FACADES:
        raise RejectedCodeError(
            f"the name {name!r} stands for the module and cannot be used for something else",
            line=line,
        )


def _check_name(node: ast.Name, names: Names) -> None:
    if isinstance(node.ctx, ast.Store):
        _check_binding(node.id, line=node.lineno)
        return
    _check_identifier(node.id, line=node.lineno)
    if node.id not in names.bound and node.id not in _AVAILABLE and node.id not in _FACADES:
        raise RejectedCodeError(
            f"the name {node.id!r} is neither defined nor among the builtins that are allowed",
            line=node.lineno,
        )


def _check_attribute(node: ast.Attribute, names: Names) -> None:
    if not isinstance(node.ctx, ast.Load):
        raise RejectedCodeError(
            f"setting the attribute {node.attr!r} is not allowed", line=node.lineno
        )
    facade = names.facade_of(node.value)
    if facade and node.attr in FACADE_NAMES[facade]:
        return
    # A name that is bound to a facade in one place may hold a value in another.
    if facade and root_of(node) in _FACADES:
        near = _nearest(node.attr, FACADE_NAMES[facade])
        raise RejectedCodeError(f"{facade} has no {node.attr!r} here{near}", line=node.lineno)
    if node.attr not in VALUE_ATTRIBUTES:
        near = _nearest(node.attr, VALUE_ATTRIBUTES)
        raise RejectedCodeError(
            f"the attribute {node.attr!r} is not allowed{near}", line=node.lineno
        )
    if node.attr in MUTATORS:
        _check_own(node, names)


def _check_subscript(node: ast.Subscript, names: Names) -> None:
    if isinstance(node.ctx, ast.Store):
        _check_own(node, names)


def _check_own(node: ast.expr, names: Names) -> None:
    root = root_of(node)
    if root in names.constants:
        raise RejectedCodeError(
            f"{root!r} is defined at the top level and cannot be changed: no call may remember "
            "another; make a copy within the function",
            line=node.lineno,
        )


def _nearest(name: str, allowed: Iterable[str]) -> str:
    near = get_close_matches(name[:LONGEST_NAME], sorted(allowed), cutoff=0.7)
    return f"; allowed are {', '.join(near)} and others" if near else ""


def _check_constant(node: ast.Constant, _: Names) -> None:
    if isinstance(node.value, bytes):
        raise RejectedCodeError("bytes are not allowed", line=node.lineno)
    if isinstance(node.value, int) and node.value >= LARGEST_INTEGER:
        raise RejectedCodeError("an integer is written out that is too large", line=node.lineno)


def _check_formatted(node: ast.FormattedValue, _: Names) -> None:
    match node.format_spec:
        case None | ast.JoinedStr(values=[]):
            return
        case ast.JoinedStr(values=[ast.Constant(value=str(spec))]) if _PLAIN_FORMAT.fullmatch(spec):
            return
    raise RejectedCodeError(
        "a format in an f-string may only be a plain one such as ':.3f' or ':>10'",
        line=node.lineno,
    )


def _check_argument(node: ast.arg, _: Names) -> None:
    _check_binding(node.arg, line=node.lineno)


def _check_keyword(node: ast.keyword, names: Names) -> None:
    if node.arg is not None:
        _check_identifier(node.arg, line=node.value.lineno)
    if node.arg in _TYPE_KEYWORDS:
        raise RejectedCodeError(f"the argument {node.arg!r} is not allowed", line=node.value.lineno)
    if node.arg == "dtype" and not is_dtype(node.value, names):
        raise RejectedCodeError(EXPECTED_DTYPE, line=node.value.lineno)
    if node.arg == "out":
        _check_own(node.value, names)


def _check_function(node: ast.FunctionDef, names: Names) -> None:
    _check_binding(node.name, line=node.lineno)
    if node.decorator_list:
        raise RejectedCodeError("a decorator is not allowed", line=node.decorator_list[0].lineno)
    own = list(own_nodes(node))
    if not any(isinstance(part, ast.Yield | ast.YieldFrom) for part in own):
        return
    # When a generator is thrown away, which may be in another's time, Python asks each of them
    # whether it handles that: a bare one runs, and of any other what it names is evaluated.
    handlers = [part for part in own if isinstance(part, ast.ExceptHandler)]
    for handler in sorted(handlers, key=lambda handler: handler.lineno):
        if handler.type is None or not _is_exception(handler.type, names):
            raise RejectedCodeError(
                "an except in a generator must name its exceptions, such as KeyError or "
                "(KeyError, ValueError)",
                line=handler.lineno,
            )


def _check_arguments(node: ast.arguments, _: Names) -> None:
    for default in (*node.defaults, *node.kw_defaults):
        for part in ast.walk(default) if default else ():
            if not isinstance(part, _PLAIN_DEFAULT):
                raise RejectedCodeError(
                    "the default of an argument can only be a number, a text, None, a name or a "
                    "tuple of these",
                    line=default.lineno if default else None,
                )


def _check_handler(node: ast.ExceptHandler, _: Names) -> None:
    if node.name is not None:
        _check_binding(node.name, line=node.lineno)


def _check_try(node: ast.Try, _: Names) -> None:
    # Nested ones are compiled into exponentially long code.
    if node.finalbody:
        raise RejectedCodeError("finally is not allowed", line=node.finalbody[0].lineno)


def _check_comprehension(node: ast.comprehension, _: Names) -> None:
    if node.is_async:
        raise RejectedCodeError("async is not allowed", line=node.target.lineno)


def _is_exception(node: ast.expr, names: Names) -> bool:
    """Return whether an expression is the plain name of an exception, or a tuple of such names."""
    match node:
        case ast.Name(id=name):
            return name in EXCEPTIONS and name not in names.bound
        case ast.Tuple(elts=elements):
            return all(_is_exception(element, names) for element in elements)
        case ast.Attribute(attr="LinAlgError", value=ast.Attribute(value=ast.Name("np"))):
            return True
        case _:
            return False


_RULES: Mapping[type[ast.AST], Callable[[Any, Names], None]] = {
    ast.Name: _check_name,
    ast.Attribute: _check_attribute,
    ast.Subscript: _check_subscript,
    ast.Constant: _check_constant,
    ast.FormattedValue: _check_formatted,
    ast.arg: _check_argument,
    ast.Call: check_call,
    ast.keyword: _check_keyword,
    ast.FunctionDef: _check_function,
    ast.arguments: _check_arguments,
    ast.ExceptHandler: _check_handler,
    ast.Try: _check_try,
    ast.comprehension: _check_comprehension,
}
