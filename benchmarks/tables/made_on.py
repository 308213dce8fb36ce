"""On what the figures of a report were made."""

from collections.abc import Iterable
from typing import Protocol


class Made(Protocol):
    """Figures that say on what they were made."""

    @property
    def machine(self) -> str:
        """What they were made on."""

    @property
    def versions(self) -> dict[str, str]:
        """Of Python and of every package that can change a result."""


def describe_made_on(made: Iterable[Made]) -> list[str]:
    """Return a sentence with the machines and one with the versions, each named once.

    Args:
        made: At least one.
    """
    ones = list(made)
    versions = ["; ".join(f"{k} {v}" for k, v in one.versions.items()) for one in ones]
    return [
        f"Machine: {' / '.join(dict.fromkeys(one.machine for one in ones))}.",
        f"Versions: {' / '.join(dict.fromkeys(versions))}.",
    ]
