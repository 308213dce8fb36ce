"""Repairing functions that fail a check, by asking the model that wrote them."""

import re
from collections.abc import Callable
from dataclasses import dataclass
from importlib import resources
from typing import TypeAlias

from lqd_llm.errors import FunctionError, MissingRecordingError, ReplyError
from lqd_llm.inquiry import Inquiry
from lqd_llm.reply import FunctionSource

MAX_REPAIRS = 3
"""How often the model is asked to repair one function."""

_PLACEHOLDER = re.compile(r"\{(PROMPT|NAME|CODE|FAILURE|DESCRIPTION|ENTRY)\}")


@dataclass(frozen=True)
class CheckFailure:
    """What a check found wrong with a function.

    Exactly this is told to the model, so nothing of an expert's verdict may be in it.

    Attributes:
        error: Name of the error, such as `"KeyError"`.
        reason: What is wrong, in words.
        line: Where in the function's code, counted from 1, if that is known.
    """

    error: str
    reason: str
    line: int | None = None

    def __str__(self) -> str:
        place = f" in line {self.line}" if self.line is not None else ""
        return f"{self.error}{place}: {self.reason.strip().rstrip('.')}"


CheckFunction: TypeAlias = Callable[[FunctionSource, str, str], CheckFailure | None]
"""A check of one function: its source, its kind (one of `lqd_llm.KINDS`) and the name of the
function in its code that is called; it returns what is wrong, or None."""


@dataclass(frozen=True)
class CheckedFunction:
    """A function that passes its check.

    Attributes:
        source: The function, as the model wrote it last; it keeps its first name.
        report: One sentence about its repair, or None where none was needed.
    """

    source: FunctionSource
    report: str | None = None


def check_and_repair(
    source: FunctionSource,
    *,
    kind: str,
    entry: str,
    prompt: str,
    check: CheckFunction,
    inquiry: Inquiry,
) -> CheckedFunction:
    """Return a function that passes its check, after up to `MAX_REPAIRS` repairs by the model.

    Args:
        source: The function as the model wrote it.
        kind: What the model was asked for, one of `lqd_llm.KINDS`.
        entry: Name of the function in the code that is called.
        prompt: The prompt that the function answers; a repair asks it again.
        check: What decides.
        inquiry: What asks the model.

    Raises:
        FunctionError: It still fails, or it fails and no repair of it is recorded.
        ProviderError: The model could not be asked, or gave no answer.
    """
    first = failure = check(source, kind, entry)
    attempt = 0
    while failure is not None:
        attempt += 1
        if attempt > MAX_REPAIRS:
            raise FunctionError(
                f"The {kind} function {source.name!r} is not used: it still fails its check after "
                f"{MAX_REPAIRS} repairs ({failure})."
            )
        repair = _render(source, failure, entry=entry, prompt=prompt)
        try:
            reply = inquiry.ask(repair, subject=f"{kind} repair", attempt=attempt)
        except MissingRecordingError as error:
            raise FunctionError(
                f"The {kind} function {source.name!r} is not used: it fails its check ({failure}), "
                "and no repair of it is recorded."
            ) from error
        except ReplyError:
            # A refused or cut reply is a repair that failed; the other functions are not at fault.
            continue
        if reply.functions:
            changed = reply.functions[0]
            source = source.model_copy(
                update={"code": changed.code, "description": changed.description}
            )
            failure = check(source, kind, entry)
    return CheckedFunction(source, _report(source, first, kind=kind, attempts=attempt))


def _report(
    source: FunctionSource, first: CheckFailure | None, *, kind: str, attempts: int
) -> str | None:
    if first is None:
        return None
    repairs = "1 repair" if attempts == 1 else f"{attempts} repairs"
    return (
        f"The {kind} function {source.name!r} passes its check after {repairs} (before: {first})."
    )


def _render(source: FunctionSource, failure: CheckFailure, *, entry: str, prompt: str) -> str:
    file = resources.files("lqd_llm").joinpath("prompts", "repair.md")
    values = {
        "PROMPT": prompt,
        "NAME": source.name,
        "CODE": source.code.strip("\n"),
        "FAILURE": str(failure),
        "DESCRIPTION": source.description,
        "ENTRY": entry,
    }
    # One pass: a placeholder inside a value must reach the model as it is.
    return _PLACEHOLDER.sub(lambda match: values[match[1]], file.read_text("utf-8").strip())
