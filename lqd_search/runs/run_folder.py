"""A run on disk: configuration, functionals, archive, metrics and figures."""

import json
from collections.abc import Sequence
from contextlib import AbstractContextManager, suppress
from dataclasses import asdict, dataclass
from os import PathLike
from pathlib import Path
from shlex import quote
from shutil import copytree
from typing import Any

from lqd_envs.atomic_file import sync_folder, write_atomically
from lqd_search.runs.function_text import FunctionText
from lqd_search.runs.functionals_folder import (
    FunctionalsFolderError,
    read_functionals,
    write_functionals,
)
from lqd_search.runs.functionals_index import Origin
from lqd_search.runs.json_form import FormError, check_form
from lqd_search.runs.kept_state import KeptState
from lqd_search.runs.metrics_file import MetricsFile
from lqd_search.runs.new_folder import (
    cannot_make,
    copy_to_disk,
    folder_beside,
    refuse_existing,
)
from lqd_search.runs.run_config import RUN_FORMAT, RunConfig
from lqd_search.runs.run_folder_error import RunFolderError, cannot_write
from lqd_search.runs.run_lock import locked
from lqd_search.runs.run_state import RunState
from lqd_search.runs.stored_archive import PASSIVE, StoredArchive, StoredArchiveError
from lqd_search.runs.stored_outcomes import Outcomes, load_outcomes
from lqd_search.runs.summary import Summary

CONFIG, METRICS, SUMMARY = "config.json", "metrics.csv", "summary.json"
ARCHIVE, OUTCOMES = "archive.npz", "outcomes.npz"
FUNCTIONALS, INFERENCE, PICTURES = "functionals", "inference", "pictures"


@dataclass(frozen=True)
class RunFolder:
    """The folder of one run.

    Attributes:
        path: Where it is.
    """

    path: Path

    @classmethod
    def create(
        cls,
        path: Path,
        *,
        config: RunConfig,
        functionals: Sequence[FunctionText],
        origin: Origin | None = None,
        inference: Path | None = None,
    ) -> "RunFolder":
        """Make a new run folder with its configuration and its functionals.

        Args:
            path: The folder, which does not exist.
            config: What the run was asked to do.
            functionals: What steers it, and all else that was inferred; none: the expert does.
            origin: Where they come from.
            inference: Folder of all that was asked and answered, which is copied; once this
                returns, the copy is on the disk. None: nothing.

        Raises:
            RunFolderError: The folder exists already, or cannot be written.
        """
        refuse_existing(path)
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            # Made beside its place and moved, it is there complete or not at all.
            with folder_beside(path) as part:
                cls(part)._fill(config, functionals, origin)
                if inference is not None:
                    copytree(inference, part / INFERENCE, copy_function=copy_to_disk)
                sync_folder(part)
                part.rename(path)
            # Where the folder above may not be listed, it cannot be done, and the run is there.
            with suppress(PermissionError):
                sync_folder(path.parent)
        except OSError as error:
            raise cannot_make(path, error) from error
        except FunctionalsFolderError as error:
            if isinstance(error.__cause__, OSError):
                raise cannot_make(path, error.__cause__) from error
            raise
        return cls(path)

    @classmethod
    def open(cls, path: str | PathLike[str]) -> "RunFolder":
        """Return an existing run folder.

        Raises:
            RunFolderError: There is none, or it has a layout that this version cannot read.
        """
        folder = cls(Path(path))
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
                f"Expected the layout {RUN_FORMAT} in {self.path}, got {data['format']!r}; run the "
                "search again, or use the sources of lqd-envs that wrote it."
            )
        try:
            return RunConfig.from_dict(data)
        except FormError as error:
            raise self._of_another_form("configuration", CONFIG, error) from error

    def locked(self) -> AbstractContextManager[None]:
        """Keep other processes from going on with the run, for the length of a `with` block.

        Raises:
            RunFolderError: Another process goes on with the run, or the folder cannot be written.
        """
        return locked(self.path / CONFIG)

    def load_state(self) -> RunState | None:
        """Return where the run stands; None: no generation was finished yet.

        Raises:
            CheckpointError: The checkpoint is damaged or of another form.
            RunFolderError: The configuration was changed since the run began.
        """
        state = self.state.load()
        if state is None or state.config == (config := self.config()):
            return state
        began, now = asdict(state.config), asdict(config)
        changed = [
            f"{name} {now[name]!r} instead of {began[name]!r}"
            for name in began
            if now[name] != began[name]
        ]
        raise RunFolderError(
            f"Expected the config.json of {self.path} to be as it was when the run began, but got "
            f"{', '.join(changed)}; restore it, or begin another run."
        )

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

    def outcomes(self) -> Outcomes:
        """Return every distinct success of the run, a column of k rows for each field.

        They are those of `outcomes.npz`: `solution` (k, 9), `evaluation`, `success`, `expert`,
        `ground_truth` (k, d), `digest`, `fitness/<name>` (k,) and `measures/<descriptor>` (k, d).

        Raises:
            OutcomeError: They are missing or damaged.
            RunFolderError: The run has not finished.
        """
        self._require(OUTCOMES)
        return load_outcomes(self.path / OUTCOMES)

    def archive(self) -> StoredArchive:
        """Return the run's archive.

        Raises:
            StoredArchiveError: It is missing or damaged.
            RunFolderError: The run has not finished.
        """
        self._require(ARCHIVE)
        archive = StoredArchive.load(self.path / ARCHIVE)
        missing = [name for name in PASSIVE if name not in archive.fields]
        if missing:
            raise StoredArchiveError(
                f"Expected the columns {', '.join(missing)} of the elites in "
                f"{self.path / ARCHIVE}, as each run has them, but they are missing; run the "
                "search again."
            )
        return archive

    @property
    def state(self) -> KeptState:
        """What a run that goes on keeps here."""
        return KeptState(self.path)

    @property
    def metrics(self) -> MetricsFile:
        """What writes the figures over time; `metrics_rows.read_metrics` reads them."""
        return MetricsFile(self.path / METRICS)

    @property
    def finished(self) -> bool:
        """Whether the run is finished: it has its figures."""
        return (self.path / SUMMARY).exists()

    def functionals(self) -> tuple[FunctionText, ...]:
        """Return the functionals, in order; none where the expert steers.

        Raises:
            FunctionalsFolderError: They cannot be read.
        """
        return read_functionals(self.path / FUNCTIONALS) if self.config().functionals else ()

    def write(self, name: str, content: bytes) -> Path:
        """Write a file of the folder as a whole: it is there complete, or not at all.

        Raises:
            RunFolderError: It cannot be written.
        """
        path = self.path / name
        try:
            write_atomically(path, content)
        except OSError as error:
            raise cannot_write(path, error, folder=self.path) from error
        return path

    def _fill(
        self, config: RunConfig, functionals: Sequence[FunctionText], origin: Origin | None
    ) -> None:
        (self.path / PICTURES).mkdir()
        if functionals:
            write_functionals(self.path / FUNCTIONALS, functionals, origin=origin)
        write_atomically(self.path / CONFIG, config.to_json().encode())

    def _require(self, name: str) -> None:
        if not (self.finished or (self.path / name).exists()):
            raise self._unfinished(name)

    def _unfinished(self, name: str) -> RunFolderError:
        begun = (self.path / CONFIG).exists()
        reason = "has not finished" if begun else "is not there"
        remedy = (
            f"go on with `lqd run --resume {quote(str(self.path))}`"
            if begun
            else "pass the folder that `lqd run` printed"
        )
        what = "a finished run" if begun else "a run"
        return RunFolderError(
            f"Expected {what} in {self.path}, but it {reason} (no {name}); {remedy}."
        )

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
        except (FileNotFoundError, NotADirectoryError) as error:
            raise self._unfinished(name) from error
        except (OSError, ValueError, RecursionError) as error:
            raise RunFolderError(
                f"Expected JSON in {path}, but it cannot be read ({error}); restore the file, or "
                "run the search again."
            ) from error
        if not isinstance(data, dict):
            raise RunFolderError(
                f"Expected a JSON object in {path}, got {type(data).__name__}; restore the file, "
                "or run the search again."
            )
        return data
