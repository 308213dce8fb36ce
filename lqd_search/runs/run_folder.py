"""A run on disk: configuration, functionals, archive, metrics and figures."""

import csv
import json
import os
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import asdict, dataclass, fields
from datetime import datetime
from pathlib import Path
from typing import Any

from lqd_envs import LQDError, Task
from lqd_search.runs.json_form import FormError, check_form
from lqd_search.runs.metrics import Metrics
from lqd_search.runs.run_config import RUN_FORMAT, RunConfig
from lqd_search.runs.stored_archive import StoredArchive
from lqd_search.runs.summary import Summary

CONFIG, ARCHIVE, METRICS, SUMMARY = "config.json", "archive.npz", "metrics.csv", "summary.json"
FUNCTIONALS, PICTURES = "functionals", "pictures"


class RunFolderError(LQDError):
    """A run folder that cannot be made, written or read."""


@dataclass(frozen=True)
class FunctionText:
    """The source of one functional, to be kept with the run.

    Attributes:
        kind: `success`, `fitness`, `timestamp` or `quantity`.
        name: Its name; its file is `<kind>.<name>.py`, that of the one success `success.py`.
        description: What it measures, in its author's words.
        code: Python source.
    """

    kind: str
    name: str
    description: str
    code: str


@dataclass(frozen=True)
class RunFolder:
    """The folder of one run.

    Attributes:
        path: Where it is.
    """

    path: Path

    @classmethod
    def create(
        cls, path: Path, *, config: RunConfig, functionals: Iterable[FunctionText]
    ) -> "RunFolder":
        """Make a new run folder with its configuration and its functionals' source.

        Raises:
            RunFolderError: The folder exists already, or cannot be written.
        """
        refuse_existing(path)
        folder = cls(path)
        try:
            path.mkdir(parents=True)
            (path / FUNCTIONALS).mkdir()
            (path / PICTURES).mkdir()
            for text in functionals:
                name = text.kind if text.kind == "success" else f"{text.kind}.{text.name}"
                source = f"# {' '.join(text.description.split())}\n{text.code.rstrip()}\n"
                folder.write(f"{FUNCTIONALS}/{name}.py", source.encode())
            folder.write(CONFIG, config.to_json().encode())
        except OSError as error:
            raise _cannot_make(path, error) from error
        return folder

    @classmethod
    def open(cls, path: Path) -> "RunFolder":
        """Return an existing run folder.

        Raises:
            RunFolderError: There is none, or it has a layout that this version cannot read.
        """
        folder = cls(path)
        folder.config()
        return folder

    def config(self) -> RunConfig:
        """Return the run's configuration.

        Raises:
            RunFolderError: It is missing, damaged or of another layout.
        """
        data = self._read_json(CONFIG)
        # First, since another layout may have any other keys.
        if data.get("format", RUN_FORMAT) != RUN_FORMAT:
            raise RunFolderError(
                f"Expected the layout {RUN_FORMAT} in {self.path}, got {data['format']!r}; read it "
                "with the version of lqd-envs that is named in its config.json."
            )
        try:
            return RunConfig.from_dict(data)
        except FormError as error:
            raise self._of_another_form("configuration", CONFIG, error) from error

    def summary(self) -> Summary:
        """Return the run's figures.

        Raises:
            RunFolderError: They are missing or damaged.
        """
        data: Any = self._read_json(SUMMARY)
        try:
            check_form(data, Summary)
        except FormError as error:
            raise self._of_another_form("figures", SUMMARY, error) from error
        summary: Summary = data
        return summary

    def archive(self) -> StoredArchive:
        """Return the run's archive.

        Raises:
            StoredArchiveError: It is missing or damaged.
        """
        return StoredArchive.load(self.path / ARCHIVE)

    def append_metrics(self, metrics: Metrics) -> None:
        """Add a row to `metrics.csv`, which can be watched while it grows.

        Raises:
            RunFolderError: It cannot be written.
        """
        path = self.path / METRICS
        try:
            new = not path.exists()
            with path.open("a", newline="") as file:
                writer = csv.DictWriter(file, [column.name for column in fields(Metrics)])
                if new:
                    writer.writeheader()
                writer.writerow(asdict(metrics))
        except OSError as error:
            raise _cannot_write(path, error) from error

    def write(self, name: str, content: bytes) -> Path:
        """Write a file of the folder as a whole: it is there complete, or not at all.

        Raises:
            RunFolderError: It cannot be written.
        """
        path = self.path / name
        part = path.with_name(f".{path.name}.part")
        try:
            part.write_bytes(content)
            part.replace(path)
        except OSError as error:
            with suppress(OSError):
                part.unlink()
            raise _cannot_write(path, error) from error
        return path

    def _of_another_form(self, what: str, name: str, error: FormError) -> RunFolderError:
        reason = str(error).rstrip(".")
        return RunFolderError(
            f"Expected a run's {what} in {self.path / name}, but it is of another form ({reason}); "
            "restore the file, or run the search again."
        )

    def _read_json(self, name: str) -> dict[str, Any]:
        path = self.path / name
        try:
            data = json.loads(path.read_text())
        except FileNotFoundError as error:
            reason = "has not finished" if (self.path / CONFIG).exists() else "is not there"
            raise RunFolderError(
                f"Expected a finished run in {self.path}, but it {reason} (no {name}); pass the "
                "folder that `lqd run` printed."
            ) from error
        except (OSError, ValueError, RecursionError) as error:
            raise RunFolderError(
                f"Expected JSON in {path}, but it cannot be read ({error}); restore the file, or "
                "run the search again."
            ) from error
        if not isinstance(data, dict):
            raise RunFolderError(f"Expected a JSON object in {path}, got {type(data).__name__}.")
        return data


def refuse_existing(path: Path) -> None:
    """Raise an error if there is something at the path of a new run folder.

    Raises:
        RunFolderError: There is, if only a link to nothing, or the path cannot be used.
    """
    try:
        path.lstat()
    except FileNotFoundError:
        return
    except OSError as error:
        raise _cannot_make(path, error) from error
    raise RunFolderError(
        f"Expected a new folder for the run, but {path} exists; choose another name, or leave "
        "out --out for a name with the time."
    )


def default_path(task: Task) -> Path:
    """Return a name that is still free, such as `runs/faucet-20260131-235959`."""
    stem = f"{task.name}-{datetime.now().astimezone():%Y%m%d-%H%M%S}"
    path = Path("runs") / stem
    number = 2
    while os.path.lexists(path):
        path = Path("runs") / f"{stem}-{number}"
        number += 1
    return path


def _cannot_make(path: Path, error: OSError) -> RunFolderError:
    return RunFolderError(
        f"Expected to write the run to {path}, but that failed ({error.strerror or error}); choose "
        "a folder that can be written with --out."
    )


def _cannot_write(path: Path, error: OSError) -> RunFolderError:
    return RunFolderError(
        f"Expected to write {path}, but that failed ({error.strerror or error}); see to the folder "
        "and its disk, and run the search again."
    )
