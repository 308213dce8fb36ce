"""Functionals as the terminal shows them."""

import textwrap
from collections.abc import Iterable, Iterator

from lqd_search.cli.checked_functionals import CheckedFunctionals
from lqd_search.runs.function_text import DIRECT_KINDS, SINGLE_KINDS, FunctionText

_WIDTH = 100
_INDENT = "    "


def functionals_lines(checked: CheckedFunctionals) -> Iterator[str]:
    """Yield the functionals with their code, what the checks said, and where they come from.

    No line has more than 100 characters; a longer line of code goes on, further indented, in the
    next one. What a terminal would obey instead of showing it is shown escaped.

    Args:
        checked: The functionals.
    """
    for text in checked.texts:
        yield from _function(text)
    yield from _checks(checked)
    yield from _paragraph(f"Model: {checked.model}. {checked.provenance}")
    if checked.usage is not None:
        yield from _paragraph(f"Usage: {checked.usage.summary()}.")


def _function(text: FunctionText) -> Iterator[str]:
    title = text.kind.replace(".", " ")
    yield _printable(title if text.kind in SINGLE_KINDS else f"{title} · {text.name}")
    yield from _paragraph(text.description)
    yield ""
    for line in text.code.expandtabs(4).strip("\n").split("\n"):
        yield from _folded(_printable(line.rstrip("\r")))
    yield ""


def _checks(checked: CheckedFunctionals) -> Iterator[str]:
    direct = sum(text.kind in DIRECT_KINDS for text in checked.texts)
    yield from _paragraph(
        f"Checks: {len(checked.texts)} functions pass ({direct} of them direct), of which "
        f"{len(checked.repaired)} were repaired; {len(checked.dropped)} are not used."
    )
    yield from _listed("repaired", checked.repaired)
    yield from _listed("not used", checked.dropped)
    yield from _listed("remark", checked.remarks)


def _listed(what: str, sentences: Iterable[str]) -> Iterator[str]:
    for sentence in sentences:
        yield from _paragraph(f"- {what}: {sentence}")


def _paragraph(text: str) -> list[str]:
    return textwrap.wrap(_printable(" ".join(text.split())), _WIDTH, break_on_hyphens=False)


def _folded(line: str) -> Iterator[str]:
    room = _WIDTH - len(_INDENT)
    yield f"{_INDENT}{line[:room]}".rstrip()
    further = _INDENT * 3
    rest, room = line[room:], _WIDTH - len(further)
    while rest:
        yield f"{further}{rest[:room]}"
        rest = rest[room:]


def _printable(text: str) -> str:
    # A model wrote it: a control character could rewrite what else is on the screen.
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)
