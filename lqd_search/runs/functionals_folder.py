"""A folder of functionals, one file each, that a person may read and change."""

from collections.abc import Iterable, Sequence
from pathlib import Path

from lqd_envs import LQDError
from lqd_envs.atomic_file import write_atomically
from lqd_search.runs.function_text import FUNCTION_KINDS, SINGLE_KINDS, FunctionText
from lqd_search.runs.functionals_index import INDEX, FunctionalsIndex, IndexEntry, Origin

_FILES = (
    "success.py, fitness.<name>.py, timestamp.<name>.py, quantity.<name>.py, and for methods that "
    "are steered directly direct.success.py, direct.fitness.py and direct.descriptor.py"
)

# A picture of a grid is named after two of them, and file systems take 255 characters. What a model
# named is brought to some 60 characters beforehand.
_NAME_LENGTH = 100


class FunctionalsFolderError(LQDError):
    """A folder of functionals cannot be read or written."""


def write_functionals(
    path: Path, texts: Sequence[FunctionText], *, origin: Origin | None = None
) -> None:
    """Write functionals to a folder: one file each, and an index of their order.

    Args:
        path: The folder; it is made where there is none. Files of the same names are replaced.
        texts: The functionals, of distinct files.
        origin: Where they come from, if that is known.

    Raises:
        FunctionalsFolderError: Two have the same file, one cannot have a file, or the folder cannot
            be written.
    """
    contents: dict[str, bytes] = {}
    for text in texts:
        if text.file_name in contents or _kind_and_name(text.file_name) != (text.kind, text.name):
            raise FunctionalsFolderError(
                "Expected functionals of distinct names that are identifiers, but got "
                f"{text.file_name} for {text.name!r}; rename it."
            )
        contents[text.file_name] = _encoded(text)
    index = FunctionalsIndex(tuple(map(IndexEntry.of, texts)), origin)
    try:
        path.mkdir(parents=True, exist_ok=True)
        for name, content in contents.items():
            write_atomically(path / name, content)
        write_atomically(path / INDEX, index.to_json().encode())
    except OSError as error:
        raise FunctionalsFolderError(
            f"Expected to write functionals to {path}, but that failed ({error.strerror or error});"
            " see to the folder and its disk, or name another."
        ) from error


def read_functionals(path: Path) -> tuple[FunctionText, ...]:
    """Read the functionals of a folder, as they were written or as a person left them.

    They come in the order of `FUNCTION_KINDS`, and within a kind in that in which they were
    written; those that the index does not know come last in their kind, by name. One whose file is
    gone is left out. Other files than `*.py` are passed over.

    Args:
        path: The folder.

    Raises:
        FunctionalsFolderError: There is no such folder, it holds no condition of success, a file's
            name is not that of a functional, or a file cannot be read.
    """
    entries = {entry.file_name: entry for entry in _index(path).entries}
    texts = [_read(file, entries.get(file.name)) for file in _files(path)]
    order = {file_name: place for place, file_name in enumerate(entries)}
    texts.sort(
        key=lambda text: (
            FUNCTION_KINDS.index(text.kind),
            order.get(text.file_name, len(order)),
            text.name,
        )
    )
    if not any(text.entry == "success" for text in texts):
        held = ", ".join(text.file_name for text in texts) or "no .py file at all"
        raise FunctionalsFolderError(
            f"Expected functionals with success.py in {path}, but it holds {held}; a folder of "
            f"functionals has {_FILES}."
        )
    return tuple(texts)


def read_origin(path: Path) -> Origin | None:
    """Return where the functionals of a folder come from, if it says so.

    Args:
        path: The folder.

    Raises:
        FunctionalsFolderError: Its index cannot be read.
    """
    return _index(path).origin


def _index(path: Path) -> FunctionalsIndex:
    try:
        return FunctionalsIndex.load(path / INDEX)
    except (FileNotFoundError, NotADirectoryError):
        return FunctionalsIndex()
    except (OSError, ValueError, RecursionError, LQDError) as error:
        reason = str(error).rstrip(".")
        raise FunctionalsFolderError(
            f"Expected the order of the functionals in {path / INDEX}, but it cannot be read "
            f"({reason}); restore the file, or remove it to have them by name."
        ) from error


def _files(path: Path) -> Iterable[Path]:
    try:
        return sorted(file for file in path.iterdir() if file.match("[!.]*.py"))
    except OSError as error:
        raise FunctionalsFolderError(
            f"Expected a folder of functionals at {path}, but it cannot be read "
            f"({error.strerror or error}); pass a folder that has {_FILES}."
        ) from error


def _read(file: Path, entry: IndexEntry | None) -> FunctionText:
    kind, name = _kind_and_name(file.name)
    try:
        content = file.read_bytes().decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise FunctionalsFolderError(
            f"Expected UTF-8 in {file}, but byte {error.start} is none; save it as UTF-8."
        ) from error
    except OSError as error:
        raise FunctionalsFolderError(
            f"Expected to read {file}, but that failed ({error.strerror or error}); restore the "
            "file or remove it."
        ) from error
    first, newline, code = content.partition("\n")
    if not first.startswith("#") or not newline:
        raise FunctionalsFolderError(
            f"Expected a comment that says what the function measures in the first line of {file}, "
            f"but it is {first[:60]!r}; put one such as '# How near the gripper is.' before it."
        )
    text = FunctionText(kind, name, first.removeprefix("#").strip(), code)
    return text if entry is None else entry.restored(text)


def _kind_and_name(file_name: str) -> tuple[str, str]:
    stem = file_name.removesuffix(".py")
    if stem in SINGLE_KINDS:
        return stem, stem.rpartition(".")[2]
    kind, _, name = stem.partition(".")
    if kind not in FUNCTION_KINDS or kind in SINGLE_KINDS or not name:
        raise FunctionalsFolderError(
            f"Expected only files of functionals, but got {file_name}; a folder of functionals has "
            f"{_FILES}."
        )
    if not (name.isidentifier() and name.isascii()):
        raise FunctionalsFolderError(
            f"Expected an identifier of plain letters, digits and _ as the name of a {kind}, but "
            f"got {name!r} from {file_name}; rename the file."
        )
    if len(name) > _NAME_LENGTH:
        raise FunctionalsFolderError(
            f"Expected at most {_NAME_LENGTH} characters as the name of a {kind}, but got "
            f"{len(name)} from {file_name}; files of a run are named after it: rename the file."
        )
    return kind, name


def _encoded(text: FunctionText) -> bytes:
    try:
        return text.source.encode()
    except UnicodeEncodeError as error:
        raise FunctionalsFolderError(
            f"Expected text that UTF-8 can hold in {text.file_name}, but it holds "
            f"{text.source[error.start]!r}; take it out."
        ) from error
