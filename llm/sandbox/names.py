"""The names that code binds, and those that stand for a facade."""

import ast
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from lqd_llm.sandbox.allowlist import FACADE_NAMES


@dataclass(frozen=True)
class Names:
    """The names of one piece of code.

    Attributes:
        bound: All that are bound somewhere: variables, arguments, functions.
        assigned: Those that an assignment at the top level binds.
        constants: Those of `assigned` that no function binds too and that are no facade.
        unpacking: Those that can only be functions of the code's own, or `dict`.
        facades: For each name that stands for a facade, which one: a key of `FACADE_NAMES`.
    """

    bound: frozenset[str]
    assigned: frozenset[str]
    constants: frozenset[str]
    unpacking: frozenset[str]
    facades: Mapping[str, str]

    @classmethod
    def of(cls, tree: ast.Module) -> "Names":
        """Collect the names of a syntax tree."""
        functions: set[str] = set()
        assigned: set[str] = set()
        inside: set[str] = set()
        for statement in tree.body:
            if isinstance(statement, ast.FunctionDef):
                functions.add(statement.name)
                inside.update(_bound_in(statement.args, *statement.body))
            else:
                assigned.update(_bound_in(statement))
        facades = _facades(tree)
        bound = functions | assigned | inside
        return cls(
            bound=frozenset(bound),
            assigned=frozenset(assigned),
            constants=frozenset(assigned - inside - facades.keys()),
            unpacking=_unpacking(tree, bound),
            facades=facades,
        )

    def facade_of(self, node: ast.expr) -> str | None:
        """Return which facade an expression stands for, if it does."""
        return _facade_of(node, self.facades)


def root_of(node: ast.expr) -> str | None:
    """Return the name that an expression reads from: `"a"` for `a[0].b(c)`."""
    while True:
        match node:
            case ast.Attribute(value=inner) | ast.Subscript(value=inner) | ast.Call(func=inner):
                node = inner
            case ast.Name(id=name):
                return name
            case _:
                return None


def _bound_in(*nodes: ast.AST) -> Iterator[str]:
    for node in nodes:
        for part in ast.walk(node):
            match part:
                case ast.Name(id=name, ctx=ast.Store()) | ast.arg(arg=name):
                    yield name
                case ast.FunctionDef(name=name):
                    yield name
                case ast.ExceptHandler(name=str(name)):
                    yield name


def own_nodes(function: ast.FunctionDef) -> Iterator[ast.AST]:
    """Yield what belongs to a function itself and not to one that is defined within it."""
    waiting: list[ast.AST] = list(function.body)
    while waiting:
        node = waiting.pop()
        yield node
        if not isinstance(node, ast.FunctionDef | ast.Lambda):
            waiting.extend(ast.iter_child_nodes(node))


def _unpacking(tree: ast.Module, bound: set[str]) -> frozenset[str]:
    defined = {node.name for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)}
    others = set()
    for node in ast.walk(tree):
        match node:
            case ast.Name(id=name, ctx=ast.Store()) | ast.arg(arg=name):
                others.add(name)
            case ast.ExceptHandler(name=str(name)):
                others.add(name)
    return frozenset((defined | ({"dict"} - bound)) - others)


def _facades(tree: ast.Module) -> dict[str, str]:
    facades = {name: name for name in FACADE_NAMES if "." not in name}
    for node in ast.walk(tree):
        if isinstance(node, ast.Assign) and (facade := _facade_of(node.value, facades)):
            for target in node.targets:
                if isinstance(target, ast.Name):
                    facades.setdefault(target.id, facade)
    return facades


def _facade_of(node: ast.expr, facades: Mapping[str, str]) -> str | None:
    match node:
        case ast.Name(id=name):
            return facades.get(name)
        case ast.Attribute(value=value, attr=name):
            path = f"{_facade_of(value, facades)}.{name}"
            return path if path in FACADE_NAMES else None
        case _:
            return None
