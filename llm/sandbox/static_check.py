"""The static check: whether code keeps to the allowlist, said before any of it runs."""

import ast
from collections.abc import Mapping
from dataclasses import dataclass

from lqd_llm.sandbox.allowlist import DEEPEST_TREE, MOST_NODES, NODES
from lqd_llm.sandbox.errors import RejectedCodeError
from lqd_llm.sandbox.names import Names
from lqd_llm.sandbox.plain_source import plain_source
from lqd_llm.sandbox.rules import check_rules
from lqd_llm.sandbox.syntax import compile_checked, parse
from lqd_llm.sandbox.top_level import check_entry, check_top_level

_WORDS: Mapping[str, str] = {
    "AsyncFor": "async",
    "AsyncFunctionDef": "an async function",
    "AsyncWith": "async",
    "Await": "await",
    "ClassDef": "a class",
    "Del": "del",
    "Delete": "del",
    "Global": "global",
    "Match": "match",
    "Nonlocal": "nonlocal",
    "TryStar": "except*",
    "With": "with",
}


@dataclass(frozen=True)
class CheckedSource:
    """Code that keeps to the allowlist.

    Attributes:
        source: The code as it is to be compiled: without annotations and imports, with `math` and
            `np` where modules were imported, each statement on its original line.
        entry: Name of the function in it that is called, with one argument.
    """

    source: str
    entry: str


def check_source(code: str, *, entry: str) -> CheckedSource:
    """Check code before it is run in the sandbox; nothing of it runs here.

    What is allowed is in `lqd_llm.sandbox.allowlist`. The code is meant to run in a
    `new_namespace()`, in a process that is locked and watched: how long it runs, how much memory
    it takes and what it returns cannot be seen here.

    Args:
        code: Python source of the function, with any helpers.
        entry: Name of the function that is to be called with one argument.

    Raises:
        RejectedCodeError: The code does not keep to the allowlist, or there is no such function.
    """
    source = plain_source(code)
    # What will run is what is checked, not the text that it was made from.
    tree = parse(source)
    _check_form(tree)
    names = Names.of(tree)
    check_rules(tree, names)
    check_top_level(tree, names)
    check_entry(tree, names, entry=entry)
    compile_checked(source)
    return CheckedSource(source=source, entry=entry)


def _check_form(tree: ast.Module) -> None:
    """Check kinds, number and depth of the nodes; what comes after it may then recurse."""
    waiting: list[tuple[ast.AST, int, int]] = [(tree, 1, 1)]
    count = 0
    while waiting:
        node, line, depth = waiting.pop()
        line = getattr(node, "lineno", line)
        count += 1
        if type(node) not in NODES:
            kind = type(node).__name__
            raise RejectedCodeError(f"{_WORDS.get(kind, kind)} is not allowed", line=line)
        if depth > DEEPEST_TREE:
            raise RejectedCodeError(
                f"the code is nested more than {DEEPEST_TREE} levels deep; use shorter "
                "expressions and helper functions",
                line=line,
            )
        children = reversed(list(ast.iter_child_nodes(node)))
        waiting.extend((child, line, depth + 1) for child in children)
    if count > MOST_NODES:
        raise RejectedCodeError(
            f"the code has {count} parts of syntax, more than the {MOST_NODES} allowed"
        )
