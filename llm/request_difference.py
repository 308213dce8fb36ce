"""How two requests differ, in words."""

import json
from collections.abc import Callable
from dataclasses import dataclass
from itertools import zip_longest

from lqd_llm.request import Request

_BEFORE, _SHOWN = 30, 100

_VALUES: dict[str, Callable[[Request], object]] = {
    "model": lambda request: request.options.model,
    "effort": lambda request: request.options.effort,
    "sample": lambda request: request.sample,
    "repair attempt": lambda request: request.attempt,
}

_TEXTS: dict[str, Callable[[Request], str]] = {
    "system prompt": lambda request: request.system,
    "messages": lambda request: "\n".join(f"{turn.role}: {turn.text}" for turn in request.messages),
    "schema": lambda request: json.dumps(request.schema, indent=1, sort_keys=True),
}


@dataclass(frozen=True)
class RequestDifference:
    """What sets a recorded request apart from one that is asked.

    Attributes:
        parts: For each part of the key that differs, what differs; of texts, the first line.
        lines: How many lines of their texts differ.
    """

    parts: tuple[str, ...]
    lines: int

    @property
    def distance(self) -> tuple[int, int]:
        """What to order by: the fewer parts differ the nearer, then the fewer lines."""
        return len(self.parts), self.lines


def compare(recorded: Request, asked: Request, *, any_model: bool = False) -> RequestDifference:
    """Return how a recorded request differs from one that is asked.

    Args:
        recorded: The request that was recorded.
        asked: The request that is asked now.
        any_model: Whether model, effort and schema were not recorded, so that they cannot differ.
    """
    parts: list[str] = []
    lines = 0
    for name, value in _VALUES.items():
        there, here = value(recorded), value(asked)
        if there != here and not (any_model and name in ("model", "effort")):
            parts.append(f"the {name} is {there!r} there and {here!r} here")
    for name, text in _TEXTS.items():
        if any_model and name == "schema":
            continue
        # Unlike splitlines, split("\n") keeps every character that can differ.
        pairs = list(zip_longest(text(recorded).split("\n"), text(asked).split("\n")))
        differing = [number for number, (there, here) in enumerate(pairs) if there != here]
        lines += len(differing)
        if differing:
            there, here = pairs[differing[0]]
            start = _first_difference(there, here)
            parts.append(
                f"line {differing[0] + 1} of the {name} is {_excerpt(there, start)} there and "
                f"{_excerpt(here, start)} here"
            )
    return RequestDifference(parts=tuple(parts), lines=lines)


def _first_difference(there: str | None, here: str | None) -> int:
    pairs = zip_longest(there or "", here or "")
    return next((number for number, (a, b) in enumerate(pairs) if a != b), 0)


def _excerpt(line: str | None, start: int) -> str:
    """Quote a line around the place where it differs."""
    if line is None:
        return "missing"
    begin = 0 if len(line) <= _SHOWN else max(start - _BEFORE, 0)
    end = begin + _SHOWN
    before, after = "..." if begin else "", "..." if end < len(line) else ""
    return f"{before}{line[begin:end]!r}{after}"
