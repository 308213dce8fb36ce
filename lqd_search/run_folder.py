"""A run on disk: configuration, functionals, archive, metrics and figures."""

import csv
import json
from collections.abc import Iterable
from dataclasses import asdict, dataclass, fields
from datetime import datetime
from pathlib import Path
from typing import Any

from lqd_envs import LQDError, Task
from lqd_search.metrics import Metrics
from lqd_search.run_config import RUN_FORMAT, RunConfig
from lqd_search.stored_archive import StoredArchive

CONFIG, ARCHIVE, METRICS, SUMMARY = "config.json", "archive.npz", "metrics.csv", "summary.json"
FUNCTIONALS, PICTURES = "functionals", "pictures"


class RunFolderError(LQDError):
    """A run folder that cannot be made, written or read."""


@dataclass(frozen=True)
class FunctionText:
    """The source of one functional, to be kept with the run.

    Attributes:
        kind: `success`, `fitness`, `timestamp` or `quantity`.
        name: Its name.
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
                name = text.name if text.name == text.kind else f"{text.kind}.{text.name}"
                source = f"# {' '.join(text.description.split())}\n{text.code.rstrip()}\n"
                folder.write(f"{FUNCTIONALS}/{name}.py", source.encode())
            folder.write(CONFIG, config.to_json().encode())
        except OSError as error:
            raise RunFolderError(
                f"Expected to write the run to {path}, but that failed ({error.strerror}); choose "
                "a folder that can be written with --out."
            ) from error
        return folder

    @classmethod
    def open(cls, path: Path) -> "RunFolder":
        """Return an existing run folder.

        Raises:
            RunFolderError: There is none, or it has a layout that this version cannot read.
        """
        folder = cls(path)
        if folder.config().format != RUN_FORMAT:
            raise RunFolderError(
                f"Expected the layout {RUN_FORMAT} in {path}, got {folder.config().format}; read "
                "it with the version of lqd-envs that is named in its config.json."
            )
        return folder

    def config(self) -> RunConfig:
        """Return the run's configuration."""
        try:
            return RunConfig.from_dict(self._read_json(CONFIG))
        except TypeError as error:
            raise RunFolderError(
                f"Expected a run's configuration in {self.path / CONFIG}, but it is of another "
                f"form ({error}); it may have been written by another version of lqd-envs."
            ) from error

    def summary(self) -> dict[str, Any]:
        """Return the run's figures."""
        return self._read_json(SUMMARY)

    def archive(self) -> StoredArchive:
        """Return the run's archive."""
        return StoredArchive.load(self.path / ARCHIVE)

    def append_metrics(self, metrics: Metrics) -> None:
        """Add a row to `metrics.csv`, which can be watched while it grows."""
        path = self.path / METRICS
        new = not path.exists()
        with path.open("a", newline="") as file:
            writer = csv.DictWriter(file, [column.name for column in fields(Metrics)])
            if new:
                writer.writeheader()
            writer.writerow(asdict(metrics))

    def write(self, name: str, content: bytes) -> Path:
        """Write a file of the folder as a whole: it is there complete, or not at all."""
        path = self.path / name
        part = path.with_name(f".{path.name}.part")
        part.write_bytes(content)
        part.replace(path)
        return path

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
        except (OSError, ValueError) as error:
            raise RunFolderError(
                f"Expected JSON in {path}, but it cannot be read ({error})."
            ) from error
        if not isinstance(data, dict):
            raise RunFolderError(f"Expected a JSON object in {path}, got {type(data).__name__}.")
        return data


def refuse_existing(path: Path) -> None:
    """Raise an error if there is something at the path of a new run folder.

    Raises:
        RunFolderError: There is.
    """
    if path.exists():
        raise RunFolderError(
            f"Expected a new folder for the run, but {path} exists; choose another name, or leave "
            "out --out for a name with the time."
        )


def default_path(task: Task) -> Path:
    """Return a name that is still free, such as `runs/faucet-20260131-235959`."""
    stem = f"{task.name}-{datetime.now().astimezone():%Y%m%d-%H%M%S}"
    path = Path("runs") / stem
    number = 2
    while path.exists():
        path = Path("runs") / f"{stem}-{number}"
        number += 1
    return path
