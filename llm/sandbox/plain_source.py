"""The code of a function without what need not run: annotations and imports of known modules.

What is left out is replaced within the text, so that every statement stays on its line and the
errors that a function raises name the lines that its author sees.
"""

import ast
import io
import re
import tokenize
import unicodedata
from bisect import bisect_left
from collections import defaultdict
from collections.abc import Iterator
from itertools import accumulate

from lqd_llm.sandbox.allowlist import (
    ANNOTATION_MODULES,
    DEEPEST_BRACKETS,
    IMPORTS,
    LONGEST_NAME,
    LONGEST_SOURCE,
)
from lqd_llm.sandbox.errors import RejectedCodeError
from lqd_llm.sandbox.syntax import parse

_COOKIE = re.compile(r"[ \t]*#.*?coding[:=][ \t]*([-_.a-zA-Z0-9]+)")
_INVISIBLE = frozenset({"Cc", "Cf", "Cs", "Zl", "Zp"})

_Edit = tuple[int, int, str]
"""From where to where in the text, and what to put there instead."""


def plain_source(code: str) -> str:
    r"""Return code without annotations and imports, each statement still on its line.

    An import of `math` or `numpy` becomes an assignment from the facades `math` and `np`, and one
    that only annotations need becomes `pass`, as does a type alias at the top level that is made
    from it. Whether the code is harmless is not looked at here.

    Args:
        code: The code as it came. Lines may end with `\n`, `\r\n` or `\r`.

    Raises:
        RejectedCodeError: The code is too long, does not parse, has characters that cannot be seen
            or identifiers that are not plain ASCII, or imports something else.
    """
    text = code.replace("\r\n", "\n").replace("\r", "\n")
    if len(text) > LONGEST_SOURCE:
        raise RejectedCodeError(
            f"the code has {len(text)} characters, more than the {LONGEST_SOURCE} allowed"
        )
    text += "" if text.endswith("\n") else "\n"
    _check_characters(text)
    tree = parse(text)
    tokens = _tokens(text)
    _check_tokens(tokens)
    return _edited(text, _edits(tree, _Places(text, tokens)))


def _check_characters(text: str) -> None:
    for number, line in enumerate(text.split("\n"), start=1):
        for character in line:
            if unicodedata.category(character) in _INVISIBLE and character != "\t":
                raise RejectedCodeError(
                    f"the invisible character U+{ord(character):04X} is not allowed", line=number
                )
        cookie = _COOKIE.match(line) if number <= 2 else None
        if cookie and cookie[1].lower() not in ("utf-8", "utf8"):
            raise RejectedCodeError("a declaration of the encoding is not allowed", line=number)


def _tokens(text: str) -> list[tokenize.TokenInfo]:
    try:
        return list(tokenize.generate_tokens(io.StringIO(text).readline))
    except (tokenize.TokenError, SyntaxError) as error:
        raise RejectedCodeError(f"it is not valid Python: {error.args[0]}") from error


def _check_tokens(tokens: list[tokenize.TokenInfo]) -> None:
    depth = 0
    for token in tokens:
        line = token.start[0]
        if token.type == tokenize.NAME:
            if not token.string.isascii():
                raise RejectedCodeError(
                    f"the name {token.string[:LONGEST_NAME]!r} has characters other than a-z, "
                    "A-Z, 0-9 and _",
                    line=line,
                )
            if len(token.string) > LONGEST_NAME:
                raise RejectedCodeError(
                    f"a name has more than {LONGEST_NAME} characters", line=line
                )
        if token.type == tokenize.OP:
            depth += (token.string in "([{") - (token.string in ")]}")
        if depth > DEEPEST_BRACKETS:
            raise RejectedCodeError(
                f"more than {DEEPEST_BRACKETS} brackets are open at once", line=line
            )


class _Places:
    """Where the nodes and tokens of a text are, counted in characters from its start."""

    def __init__(self, text: str, tokens: list[tokenize.TokenInfo]) -> None:
        self._lines = text.split("\n")
        self._starts = [0, *accumulate(len(line) + 1 for line in self._lines)]
        self._operators: dict[str, list[int]] = defaultdict(list)
        for token in tokens:
            if token.type == tokenize.OP:
                place = self._starts[token.start[0] - 1] + token.start[1]
                self._operators[token.string].append(place)

    def start(self, node: ast.expr | ast.stmt | ast.arg) -> int:
        return self._of(node.lineno, node.col_offset)

    def end(self, node: ast.expr | ast.stmt | ast.arg) -> int:
        return self._of(node.end_lineno or 0, node.end_col_offset or 0)

    def before(self, place: int, operator: str) -> int:
        """Return where the last such operator before a place is."""
        places = self._operators[operator]
        return places[bisect_left(places, place) - 1]

    def after(self, place: int, operator: str) -> int:
        """Return where the first such operator from a place on is."""
        places = self._operators[operator]
        return places[bisect_left(places, place)]

    def _of(self, line: int, utf8_column: int) -> int:
        before = self._lines[line - 1].encode()[:utf8_column].decode()
        return self._starts[line - 1] + len(before)


def _edits(tree: ast.Module, places: _Places) -> Iterator[_Edit]:
    aliases = _type_aliases(tree)
    for node in ast.walk(tree):
        match node:
            case ast.Assign() | ast.AnnAssign() if node in aliases:
                yield places.start(node), places.end(node), "pass"
            case ast.Import() | ast.ImportFrom():
                yield places.start(node), places.end(node), _instead_of(node)
            case ast.AnnAssign(value=None):
                yield places.start(node), places.end(node), "pass"
            case ast.AnnAssign():
                colon = places.before(places.start(node.annotation), ":")
                yield colon, places.after(places.end(node.annotation), "="), ""
            case ast.arg(annotation=ast.expr()):
                yield places.start(node) + len(node.arg), places.end(node), ""
            case ast.FunctionDef(returns=ast.expr() as returns):
                arrow = places.before(places.start(returns), "->")
                yield arrow, places.after(places.end(returns), ":"), ""


def _type_aliases(tree: ast.Module) -> set[ast.stmt]:
    """Return the assignments at the top level whose value only annotations can be meant to use."""
    names = {
        (alias.asname or alias.name).split(".")[0]
        for node in ast.walk(tree)
        if isinstance(node, ast.Import | ast.ImportFrom)
        for alias in node.names
        if (node.module if isinstance(node, ast.ImportFrom) else alias.name) in ANNOTATION_MODULES
    }
    found: set[ast.stmt] = set()
    for node in tree.body:
        match node:
            case ast.Assign(targets=[ast.Name(id=name)], value=ast.expr() as value):
                pass
            case ast.AnnAssign(target=ast.Name(id=name), value=ast.expr() as value):
                pass
            case _:
                continue
        if any(isinstance(part, ast.Name) and part.id in names for part in ast.walk(value)):
            found.add(node)
            names.add(name)
    return found


def _instead_of(node: ast.Import | ast.ImportFrom) -> str:
    if isinstance(node, ast.Import):
        parts = [_instead_of_module(alias, line=node.lineno) for alias in node.names]
    elif node.module in ANNOTATION_MODULES and not node.level:
        parts = []
    else:
        facade = _facade("." * node.level + (node.module or ""), line=node.lineno)
        parts = [_instead_of_member(alias, facade, line=node.lineno) for alias in node.names]
    return "; ".join(part for part in parts if part) or "pass"


def _instead_of_module(alias: ast.alias, *, line: int) -> str:
    if alias.name in ANNOTATION_MODULES:
        return ""
    facade = _facade(alias.name, line=line)
    if alias.asname is None:
        # `import numpy.linalg` binds `numpy`.
        return _binding(alias.name.split(".")[0], facade.split(".")[0])
    return _binding(alias.asname, facade)


def _instead_of_member(alias: ast.alias, facade: str, *, line: int) -> str:
    if alias.name == "*":
        raise RejectedCodeError(f"'*' cannot be imported; write {facade}.name instead", line=line)
    return _binding(alias.asname or alias.name, f"{facade}.{alias.name}")


def _facade(module: str, *, line: int) -> str:
    if module not in IMPORTS:
        raise RejectedCodeError(
            f"importing {module!r} is not allowed; math and np are there already",
            line=line,
        )
    return IMPORTS[module]


def _binding(name: str, value: str) -> str:
    return "" if name == value else f"{name} = {value}"


def _edited(text: str, edits: Iterator[_Edit]) -> str:
    # From the last to the first, so that the places of those that are left stay true.
    for start, end, words in sorted(edits, reverse=True):
        lines = text.count("\n", start, end)
        # A continued line may stand inside of brackets and outside of them.
        text = text[:start] + words + " \\\n" * lines + text[end:]
    return text
