"""The functionals of runs as highlighted source."""

from collections.abc import Sequence
from dataclasses import dataclass

from markupsafe import Markup
from pygments import highlight
from pygments.formatters import HtmlFormatter
from pygments.lexers import PythonLexer

from lqd_search.report.reported_run import ReportedRun
from lqd_search.runs.function_text import SINGLE_KINDS, FunctionText

_STYLE = "friendly"


@dataclass(frozen=True)
class Listing:
    """One functional.

    Attributes:
        title: Its kind and name.
        description: What it measures, in its author's words.
        code: Its source, escaped and highlighted.
    """

    title: str
    description: str
    code: Markup


@dataclass(frozen=True)
class Listings:
    """The functionals that some runs have in common.

    Attributes:
        runs: Labels of these runs.
        listings: Their functionals, in order.
    """

    runs: tuple[str, ...]
    listings: tuple[Listing, ...]


def listings_of(runs: Sequence[ReportedRun]) -> tuple[Listings, ...]:
    """Return every run's functionals; those of runs that have the same ones, once."""
    groups: dict[tuple[FunctionText, ...], list[str]] = {}
    for run in runs:
        groups.setdefault(run.functionals, []).append(run.label)
    return tuple(
        Listings(runs=tuple(labels), listings=tuple(map(_listing, functionals)))
        for functionals, labels in groups.items()
        if functionals
    )


def highlighting_style() -> str:
    """Return the style sheet that colors the source."""
    style: str = HtmlFormatter(style=_STYLE).get_style_defs(".source")
    return style


def _listing(text: FunctionText) -> Listing:
    title = text.kind.replace(".", " ") if text.kind in SINGLE_KINDS else f"{text.kind} {text.name}"
    # Escapes all that the page could take for markup.
    markup = highlight(text.code, PythonLexer(), HtmlFormatter(nowrap=True))
    return Listing(title, text.description, Markup(markup))
