"""Repairing functions that fail a check, by asking the model that wrote them."""

from dataclasses import dataclass, replace

from lqd_llm.check import Candidate, CheckFailure, CheckFunction, CheckOutcome
from lqd_llm.errors import FunctionError, MissingRecordingError, ReplyError
from lqd_llm.inquiry import Inquiry
from lqd_llm.prompts import fill_template

MAX_REPAIRS = 3
"""How often the model is asked to repair one function."""


@dataclass(frozen=True)
class CheckedFunction:
    """A function that passes its check.

    Attributes:
        candidate: The function, as the model wrote it last; it keeps its first name.
        outcome: What its check found.
        report: One sentence about its repair, or None where none was needed.
    """

    candidate: Candidate
    outcome: CheckOutcome
    report: str | None = None


def repair(
    candidate: Candidate,
    outcome: CheckOutcome,
    *,
    prompt: str,
    check: CheckFunction,
    inquiry: Inquiry,
) -> CheckedFunction:
    """Return a function that passes its check, after up to `MAX_REPAIRS` repairs by the model.

    Args:
        candidate: The function as the model wrote it.
        outcome: What came of its check; where it passes, nothing is repaired.
        prompt: The prompt that the function answers; a repair asks it again.
        check: What decides, once it has been repaired.
        inquiry: What asks the model.

    Raises:
        FunctionError: It still fails, or it fails and no repair of it is recorded.
        ProviderError: The model could not be asked, or gave no answer.
    """
    first = outcome.failure
    attempt = 0
    while (failure := outcome.failure) is not None:
        attempt += 1
        if attempt > MAX_REPAIRS:
            raise FunctionError(
                f"{_named(candidate)} is not used: it still fails its check after {MAX_REPAIRS} "
                f"repairs ({failure})."
            )
        try:
            reply = inquiry.ask(
                _render(candidate, failure, prompt=prompt),
                subject=f"{candidate.kind} repair",
                attempt=attempt,
            )
        except MissingRecordingError as error:
            raise FunctionError(
                f"{_named(candidate)} is not used: it fails its check ({failure}), and no repair "
                "of it is recorded."
            ) from error
        except ReplyError:
            # A refused or cut reply is a repair that failed; the other functions are not at fault.
            continue
        if reply.functions:
            told = reply.functions[0]
            changed = {"code": told.code, "description": told.description}
            candidate = replace(candidate, source=candidate.source.model_copy(update=changed))
            (outcome,) = check([candidate])
    return CheckedFunction(candidate, outcome, _report(candidate, first, attempts=attempt))


def _report(candidate: Candidate, first: CheckFailure | None, *, attempts: int) -> str | None:
    if first is None:
        return None
    repairs = "1 repair" if attempts == 1 else f"{attempts} repairs"
    return f"{_named(candidate)} passes its check after {repairs} (before: {first})."


def _named(candidate: Candidate) -> str:
    return f"The {candidate.kind} function {candidate.source.name!r}"


def _render(candidate: Candidate, failure: CheckFailure, *, prompt: str) -> str:
    values = {
        "PROMPT": prompt,
        "NAME": candidate.source.name,
        "CODE": candidate.source.code.strip("\n"),
        "FAILURE": str(failure),
        "DESCRIPTION": candidate.source.description,
        "ENTRY": candidate.entry,
    }
    return fill_template("repair", values)
