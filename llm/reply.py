"""A model's reply: the sources of one or more functions."""

import keyword
import re
from collections.abc import Iterable

from pydantic import BaseModel, ConfigDict, Field, field_validator

_NAME_LENGTH = 60


def _identifier(name: str) -> str:
    """Make a name an ASCII snake_case identifier; a name that is one already stays as it is."""
    plain = re.sub(r"[^a-z0-9_]+", "_", name.lower()).strip("_")[:_NAME_LENGTH].rstrip("_")
    if not plain:
        return "function"
    if plain[0].isdigit():
        return f"_{plain}"
    return f"{plain}_" if keyword.iskeyword(plain) else plain


def _unique(names: Iterable[str]) -> list[str]:
    """Append `_2`, `_3` and so on to every name that came before."""
    taken: dict[str, None] = {}
    for name in names:
        candidate, number = name, 1
        while candidate in taken:
            number += 1
            candidate = f"{name}_{number}"
        taken[candidate] = None
    return list(taken)


class FunctionSource(BaseModel):
    """One function as a model wrote it.

    Names become file names and column names, so a name that a model sent is brought into one form:
    lower case, each run of other characters than `a-z`, `0-9` and `_` turned into one `_`, no `_`
    at either end, at most 60 characters; then `_` before a leading digit, `_` after a Python
    keyword, and `function` when nothing is left.

    Attributes:
        name: A short snake_case name, a valid identifier.
        description: What the function measures, in one line.
        code: Python source of the function, with any helpers; exactly as it came.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    name: str = Field(description="short snake_case name")
    description: str = Field(description="one line: what it measures")
    code: str = Field(description="Python source of the function, with any helpers")

    @field_validator("name")
    @classmethod
    def _name_is_an_identifier(cls, name: str) -> str:
        return _identifier(name)


class Reply(BaseModel):
    """All functions of one reply, in the order in which the model wrote them.

    A name that a function before it has already gets `_2` appended, or `_3`, and so on.

    Attributes:
        functions: The functions; their names are distinct.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    functions: tuple[FunctionSource, ...]

    @field_validator("functions")
    @classmethod
    def _names_are_unique(cls, functions: tuple[FunctionSource, ...]) -> tuple[FunctionSource, ...]:
        names = _unique(function.name for function in functions)
        return tuple(
            function.model_copy(update={"name": name})
            for function, name in zip(functions, names, strict=True)
        )
