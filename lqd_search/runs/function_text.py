"""The source of a functional, as it is kept with a run."""

from dataclasses import dataclass


@dataclass(frozen=True)
class FunctionText:
    """The source of one functional, to be kept with the run.

    Attributes:
        kind: `success`, `fitness`, `timestamp`, `quantity` or `descriptor`.
        name: Its name; its file is `<kind>.<name>.py`, that of the one success `success.py`.
        description: What it measures, in its author's words.
        code: Python source.
    """

    kind: str
    name: str
    description: str
    code: str

    @property
    def file_name(self) -> str:
        """Name of its file."""
        return f"{self.kind}.py" if self.kind == "success" else f"{self.kind}.{self.name}.py"

    @property
    def source(self) -> str:
        """The content of its file."""
        return f"# {' '.join(self.description.split())}\n{self.code.rstrip()}\n"
