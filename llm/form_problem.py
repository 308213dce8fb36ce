"""The first thing that is wrong with the form of a text."""

from dataclasses import dataclass

from pydantic import ValidationError


@dataclass(frozen=True)
class FormProblem:
    """Where a text has another form than was expected, and what is wrong there.

    Attributes:
        place: The keys that lead there.
        message: What is wrong.
        kind: Pydantic's name for such a problem.
    """

    place: str
    message: str
    kind: str

    @classmethod
    def first(cls, error: ValidationError) -> "FormProblem":
        """Return the first problem that an error names."""
        first = error.errors(include_url=False, include_input=False)[0]
        place = ".".join(map(str, first["loc"])) or "the top level"
        return cls(place=place, message=first["msg"], kind=first["type"])

    def __str__(self) -> str:
        """Return it as `place: message`."""
        return f"{self.place}: {self.message}"
