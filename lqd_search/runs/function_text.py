"""The source of a functional, as it is kept with a run."""

from collections.abc import Iterable
from dataclasses import dataclass
from hashlib import sha256

DIRECT_KINDS = ("direct.success", "direct.fitness", "direct.descriptor")
"""The kinds of the functions that a model writes when it is asked for everything at once."""

SINGLE_KINDS = ("success", *DIRECT_KINDS)
"""The kinds of which there is only one function."""

FUNCTION_KINDS = ("success", "fitness", "timestamp", "quantity", *DIRECT_KINDS)
"""What a functional may be."""


@dataclass(frozen=True)
class FunctionText:
    """The source of one functional, to be kept with the run.

    Attributes:
        kind: One of `FUNCTION_KINDS`.
        name: Its name, an identifier, distinct from the others of its kind. One of a kind of which
            there is only one is called as the last word of the kind says.
        description: What it measures, in its author's words.
        code: Python source.
    """

    kind: str
    name: str
    description: str
    code: str

    @property
    def file_name(self) -> str:
        """Name of its file: `<kind>.<name>.py`, or `<kind>.py` where there is only one."""
        return f"{self.kind}.py" if self.kind in SINGLE_KINDS else f"{self.kind}.{self.name}.py"

    @property
    def entry(self) -> str:
        """Name of the function in its code that is called: the last word of its kind."""
        return self.kind.rpartition(".")[2]

    @property
    def source(self) -> str:
        """The content of its file."""
        return f"# {' '.join(self.description.split())}\n{self.code.rstrip()}\n"


def functionals_digest(texts: Iterable[FunctionText]) -> str:
    """Return a digest of functionals: another one where a file or their order is another.

    Args:
        texts: The functionals, in order.
    """
    digest = sha256()
    for text in texts:
        for part in (text.file_name, text.source):
            digest.update(sha256(part.encode()).digest())
    return digest.hexdigest()
