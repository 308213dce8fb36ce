"""Choosing from a reply the functions that can be used."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

from lqd_llm.check import Candidate
from lqd_llm.errors import FunctionError, InferenceError
from lqd_llm.functions import DIRECT_ENTRIES, ENTRIES, InferredFunction
from lqd_llm.prompts import COUNTS
from lqd_llm.reply import FunctionSource, Reply

MakeFunction: TypeAlias = Callable[[FunctionSource, str, str], InferredFunction]
"""Makes a function of its source, its kind and the name of the function in its code that is called.
It raises `FunctionError` where the function cannot be used."""

# Of functions that cannot be used, where a reply holds very many.
_MOST_TOLD = 5


@dataclass(frozen=True)
class FunctionChoice:
    """The functions of a reply that can be used.

    Attributes:
        functions: The functions; never empty.
        dropped: One sentence for each function that is not used.
    """

    functions: tuple[InferredFunction, ...]
    dropped: tuple[str, ...]


def candidates_of(reply: Reply, *, kind: str) -> list[Candidate]:
    """Return the functions of a reply that are chosen if all of them can be used, in order."""
    if kind == "direct":
        named = [source for source in reply.functions if source.name in DIRECT_ENTRIES]
        return [Candidate(source, kind, source.name) for source in named]
    return [Candidate(source, kind, ENTRIES[kind]) for source in reply.functions[: COUNTS[kind]]]


def choose_functions(reply: Reply, *, kind: str, make: MakeFunction) -> FunctionChoice:
    """Make the first functions that can be used, up to the number that was asked for.

    Raises:
        InferenceError: None can be used.
    """
    entry, count = ENTRIES[kind], COUNTS[kind]
    functions: list[InferredFunction] = []
    dropped: list[str] = []
    for source in reply.functions:
        if len(functions) == count:
            dropped.append(
                f"The {kind} function {source.name!r} is not used: {count} came before it, as many "
                "as were asked for."
            )
            continue
        try:
            functions.append(make(source, kind, entry))
        except FunctionError as error:
            dropped.append(str(error))
    if not functions:
        raise InferenceError(_nothing_left(f"a {kind} function", reply, dropped=dropped))
    return FunctionChoice(functions=tuple(functions), dropped=tuple(dropped))


def choose_direct(reply: Reply, *, make: MakeFunction) -> FunctionChoice:
    """Make the three functions of the kind `direct`, in the order of `DIRECT_ENTRIES`.

    Raises:
        InferenceError: One of them cannot be used.
    """
    functions: dict[str, InferredFunction] = {}
    dropped: list[str] = []
    for source in reply.functions:
        if source.name not in DIRECT_ENTRIES:
            dropped.append(
                f"The direct function {source.name!r} is not used: expected the names "
                f"{', '.join(DIRECT_ENTRIES)}."
            )
            continue
        try:
            functions[source.name] = make(source, "direct", source.name)
        except FunctionError as error:
            dropped.append(str(error))
    for entry in DIRECT_ENTRIES:
        if entry not in functions:
            raise InferenceError(_nothing_left(f"a direct {entry}", reply, dropped=dropped))
    return FunctionChoice(
        functions=tuple(functions[entry] for entry in DIRECT_ENTRIES), dropped=tuple(dropped)
    )


def _nothing_left(wanted: str, reply: Reply, *, dropped: list[str]) -> str:
    names = ", ".join(source.name for source in reply.functions[:_MOST_TOLD]) or "an empty reply"
    more = len(reply.functions) - _MOST_TOLD
    names += f" and {more} more" if more > 0 else ""
    sentence = f"Expected {wanted} that can be used, got none out of {names}; take another sample."
    return " ".join([sentence, *dropped[:_MOST_TOLD]])
