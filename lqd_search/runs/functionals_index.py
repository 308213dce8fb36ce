"""The index of a folder of functionals: what their files do not say."""

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, TypedDict

from lqd_search.runs.function_text import FunctionText
from lqd_search.runs.json_form import FormError, check_form, known_keys

INDEX = "functionals.json"
"""Name of the file."""

_FORMAT = 1


@dataclass(frozen=True)
class Origin:
    """Where functionals come from.

    Attributes:
        instruction: The sentence that they were inferred for.
        model: The model that wrote them, as far as it is known.
        provenance: How its replies were taken.
        prompt_hashes: For each kind of prompt, the hash of the prompts that were answered.
    """

    instruction: str
    model: str
    provenance: str
    prompt_hashes: dict[str, str]


@dataclass(frozen=True)
class IndexEntry:
    """What the file of one functional does not say.

    Attributes:
        file_name: Name of the file.
        description: What it measures; its file has that on a single line.
        ending: The white space after its code; its file ends with one newline instead.
    """

    file_name: str
    description: str
    ending: str

    @classmethod
    def of(cls, text: FunctionText) -> "IndexEntry":
        """Return the entry of a functional."""
        ending = text.code[len(text.code.rstrip()) :]
        return cls(text.file_name, text.description, ending)

    def restored(self, text: FunctionText) -> FunctionText:
        """Return a functional as it was written, or as it is read where somebody changed it.

        Args:
            text: What was read from its file.
        """
        code = text.code.rstrip() + self.ending
        written = FunctionText(text.kind, text.name, self.description, code)
        description_is_old = text.description == " ".join(self.description.split())
        return FunctionText(
            kind=text.kind,
            name=text.name,
            description=self.description if description_is_old else text.description,
            code=code if text.code == _body(written) else text.code,
        )


class _Form(TypedDict):
    format: int
    functionals: list[IndexEntry]


@dataclass(frozen=True)
class FunctionalsIndex:
    """The index of a folder.

    Attributes:
        entries: One for each functional, in order.
        origin: Where they come from, if that is known.
    """

    entries: tuple[IndexEntry, ...] = ()
    origin: Origin | None = None

    def to_json(self) -> str:
        """Return the index as the text of its file."""
        origin = None if self.origin is None else asdict(self.origin)
        content = {
            "format": _FORMAT,
            "origin": origin,
            "functionals": [asdict(entry) for entry in self.entries],
        }
        return f"{json.dumps(content, indent=1)}\n"

    @classmethod
    def load(cls, path: Path) -> "FunctionalsIndex":
        """Read an index.

        Args:
            path: Its file.

        Raises:
            OSError: It cannot be read.
            ValueError: It is not JSON.
            FormError: It is of another form.
        """
        data: Any = json.loads(path.read_bytes())
        check_form(data, _Form)
        if data["format"] != _FORMAT:
            raise FormError(f"Expected the format {_FORMAT}, but got {data['format']}.")
        origin = data.get("origin")
        if origin is not None:
            check_form(origin, Origin, at="origin")
        return cls(
            tuple(IndexEntry(**known_keys(entry, IndexEntry)) for entry in data["functionals"]),
            None if origin is None else Origin(**known_keys(origin, Origin)),
        )


def _body(text: FunctionText) -> str:
    return text.source.partition("\n")[2]
