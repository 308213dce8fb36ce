"""The names that code binds, and those that stand for a facade."""

import ast
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from lqd_llm.sandbox.allowlist import FACADE_NAMES, NUMPY_CREATORS

_MAKE_ARRAYS = frozenset({*NUMPY_CREATORS, "astype", "copy"})


@dataclass(frozen=True)
class Names:
    """The names of one piece of code.

    Attributes:
        bound: All that are bound somewhere: variables, arguments, functions.
        assigned: Those that an assignment at the top level binds.
        constants: Those of `assigned` that no function binds too and that are no facade.
        unpacking: Those that can only be functions of the code's own, or `dict`.
        arrays: Those that nothing but a new array is ever assigned to.
        facades: For each name that stands for a facade, which one: a key of `FACADE_NAMES`.
    """

    bound: frozenset[str]
    assigned: frozenset[str]
    constants: frozenset[str]
    unpacking: frozenset[str]
    arrays: frozenset[str]
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
            arrays=_arrays(tree),
            facades=facades,
        )

    def facade_of(self, node: ast.expr) -> str | None:
        """Return which facade an expression stands for, if it does."""
        return _facade_of(node, self.facades)

    def is_array(self, node: ast.expr) -> bool:
        """Return whether an expression gives an array for sure, wherever it can be evaluated."""
        return _makes_array(node) or (isinstance(node, ast.Name) and node.id in self.arrays)


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


def _arrays(tree: ast.Module) -> frozenset[str]:
    targets = [
        target
        for node in ast.walk(tree)
        if isinstance(node, ast.Assign) and _makes_array(node.value)
        for target in node.targets
        if isinstance(target, ast.Name)
    ]
    bound = Counter(_bound_in(tree))
    assigned = Counter(target.id for target in targets)
    return frozenset(name for name, times in assigned.items() if times == bound[name])


def _makes_array(node: ast.expr) -> bool:
    # Only `np` and arrays have these; what else has a `copy` gives nothing that numbers go into.
    match node:
        case ast.Call(func=ast.Attribute(attr=name)):
            return name in _MAKE_ARRAYS
        case _:
            return False


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
