"""Trying a corpus of functions: harmless ones, and attacks."""

import json
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lqd_llm.sandbox.errors import RejectedCodeError, SandboxError
from lqd_llm.sandbox.functions import SandboxedFunction
from lqd_llm.sandbox.info_layout import InfoLayout
from lqd_llm.sandbox.limits import Limits
from lqd_llm.sandbox.results import Results
from lqd_llm.sandbox.roles import Role
from lqd_llm.sandbox.sandbox import Sandbox
from lqd_llm.sandbox.static_check import CheckedSource, check_source

OUTCOMES = ("ok", "rejected", "timeout", "memory", "bad_value", "contained", "escaped")
"""What may come of a line. `escaped`: a canary file appeared; no line ever expects it."""

CORPUS_LIMITS = Limits(cpu_seconds=0.3, memory_bytes=512 << 20)
"""Enough for a function that does no harm, and little enough to try a hundred that do."""

_CANARY = "sandbox_canary*"
_LAST = SandboxedFunction(
    "last", Role.TIMESTAMP, CheckedSource("def last(infos):\n    return infos[-1]\n", "last")
)


@dataclass(frozen=True)
class CorpusLine:
    """One line of a corpus.

    Attributes:
        name: Its name.
        kind: What its function poses as.
        entry: Name of the function in the code that is called.
        code: The code.
        expected: The expected outcome, one of `OUTCOMES`.
        also_ok: Outcomes that are as good.
    """

    name: str
    kind: Role
    entry: str
    code: str
    expected: str
    also_ok: tuple[str, ...] = ()


@dataclass(frozen=True)
class CorpusOutcome:
    """What came of one line.

    Attributes:
        line: The line.
        outcome: One of `OUTCOMES`. A function that ran, whatever its value, is said to be
            `contained` when the line expects that rather than what became of the value.
        detail: Why, in words; empty for an outcome that says it all.
    """

    line: CorpusLine
    outcome: str
    detail: str = ""

    @property
    def as_expected(self) -> bool:
        """Whether it is the expected outcome, or one that is as good."""
        return self.outcome in (self.line.expected, *self.line.also_ok)


def read_corpus(path: Path) -> tuple[CorpusLine, ...]:
    """Read a file of one JSON object a line.

    Raises:
        SandboxError: The file cannot be read, or a line is not of the right form.
    """
    try:
        texts = path.read_text(encoding="utf-8").split("\n")
    except (OSError, UnicodeDecodeError) as error:
        raise SandboxError(f"The corpus {path} cannot be read ({error}).") from error
    return tuple(
        _line(text, where=f"{path}:{n}") for n, text in enumerate(texts, 1) if text.strip()
    )


def run_corpus(
    lines: Iterable[CorpusLine],
    *,
    layout: InfoLayout,
    columns: Mapping[str, NDArray[Any]],
    limits: Limits = CORPUS_LIMITS,
    allow_weak: bool = False,
) -> Iterator[CorpusOutcome]:
    """Try the functions of a corpus one after the other, each in a sandbox of its own.

    A function that passes the static check runs twice on the motions, and must give the same.

    Args:
        lines: The lines.
        layout: The keys of an info.
        columns: Example motions, (N, T, ...) for each key.
        limits: What a function may use.
        allow_weak: Whether to go on without the locks that this system does not have.

    Yields:
        The outcome of each line, in order.

    Raises:
        SandboxError: The sandbox cannot be used.
    """
    for line in lines:
        before = _canaries()
        seen, detail = _try(
            line, layout=layout, columns=columns, limits=limits, allow_weak=allow_weak
        )
        if appeared := _canaries() - before:
            yield CorpusOutcome(line, "escaped", f"{', '.join(sorted(appeared))} appeared")
        else:
            yield CorpusOutcome(line, _named(seen, line), detail)


def _line(text: str, *, where: str) -> CorpusLine:
    try:
        told = json.loads(text)
        line = CorpusLine(
            name=str(told["name"]),
            kind=Role(told["kind"]),
            entry=str(told["entry"]),
            code=str(told["code"]),
            expected=str(told["expected"]),
            also_ok=tuple(map(str, told.get("also_ok") or ())),
        )
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise SandboxError(
            f"Expected an object with name, kind, entry, code and expected, but {where} is "
            f"another ({error}); correct that line."
        ) from error
    if unknown := {line.expected, *line.also_ok} - set(OUTCOMES):
        raise SandboxError(
            f"Expected the outcomes {', '.join(OUTCOMES)}, but {where} names "
            f"{', '.join(sorted(unknown))}; correct that line."
        )
    return line


def _try(
    line: CorpusLine,
    *,
    layout: InfoLayout,
    columns: Mapping[str, NDArray[Any]],
    limits: Limits,
    allow_weak: bool,
) -> tuple[str, str]:
    try:
        source = check_source(line.code, entry=line.entry)
    except RejectedCodeError as error:
        return "rejected", str(error)
    functions = [SandboxedFunction(line.name, line.kind, source)]
    if line.kind is Role.QUANTITY:
        functions.append(_LAST)
    with Sandbox(layout, functions=functions, limits=limits, allow_weak=allow_weak) as sandbox:
        first, second = sandbox.run(columns), sandbox.run(columns)
        dropped = sandbox.dropped
    if dropped:
        causes = {"timeout": "timeout", "memory": "memory"}
        return causes.get(dropped[0].cause, "bad_value"), str(dropped[0])
    if first.refusals:
        return "bad_value", f"it {first.refusals[0].reason}"
    if not _same(first, second):
        return "bad_value", "it gave something else the second time"
    return "ok", ""


def _named(seen: str, line: CorpusLine) -> str:
    accepted = (line.expected, *line.also_ok)
    ran = seen in ("ok", "bad_value")
    if seen not in accepted and ran and "contained" in accepted:
        return "contained"
    return seen


def _same(first: Results, second: Results) -> bool:
    return all(
        np.array_equal(ours, theirs, equal_nan=True)
        for ours, theirs in zip(_arrays(first), _arrays(second), strict=True)
    )


def _arrays(results: Results) -> list[NDArray[Any]]:
    return [
        *results.success.values(),
        *results.fitness.values(),
        *results.moments.values(),
        *results.quantities.values(),
        *results.descriptors.values(),
    ]


def _canaries() -> set[str]:
    places = {Path.cwd(), Path("/"), Path(tempfile.gettempdir()), Path.home()}
    return {str(path) for place in places for path in place.glob(_CANARY)}
