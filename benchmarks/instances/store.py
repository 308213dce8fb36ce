"""The judgements on disk: a file for each run."""

import gzip
import zlib
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from benchmarks.instances.fingerprint import fingerprint
from benchmarks.instances.judged_run import InstancesError, RunLabel
from benchmarks.instances.judgement import Judgement
from lqd_envs.atomic_file import write_atomically
from lqd_envs.folder_lock import folder_locked

_SUFFIX = ".jsonl.gz"

Keep = Callable[[Judgement], None]
"""Keeps a judgement of a run."""


@dataclass(frozen=True)
class JudgementStore:
    """The folder of judgements: `judged/<run>.jsonl.gz`, a line of JSON for each instance.

    Attributes:
        out: The folder that it is in.
        cap: Most motions that were drawn for simulation. A judgement with another one, or with
            anything else declared otherwise than now, is none.
    """

    out: Path
    cap: int

    @contextmanager
    def alone(self) -> Iterator[None]:
        """Keep other processes from writing in the same folder, for the length of a `with` block.

        A file is read before it is written: of two that add to it one would lose what it judged.
        Nor can two write the same report at the same time.

        Raises:
            InstancesError: Another process judges there, or the folder cannot be made.
        """
        with ExitStack() as stack:
            try:
                alone = stack.enter_context(folder_locked(self._judged))
            except OSError as error:
                raise cannot_write(self._judged, error) from error
            if not alone:
                raise InstancesError(
                    f"Expected to be the only one that judges in {self.out}, but another process "
                    "does; wait until it ends, or choose another folder with --out."
                )
            yield

    def load(self, run: RunLabel) -> dict[str, Judgement]:
        """Return what a run's archive came to in all instances that it has been judged by.

        Returns:
            The judgements, by the names of their instances.

        Raises:
            InstancesError: The file is damaged, or that of another run.
        """
        return {
            name: judgement
            for name, judgement in self._all(run).items()
            if judgement.declared == self._declared
        }

    def keeping(self, run: RunLabel) -> Keep:
        """Return what adds a judgement of a run, or puts it in the place of an earlier one.

        What is there already is read once; so there must not be two for the same run.

        Raises:
            InstancesError: The file is damaged or that of another run, or, of what is returned, it
                cannot be written.
        """
        path = self._path(run)
        lines = {name: one.to_json() for name, one in self._all(run).items()}

        def keep(judgement: Judgement) -> None:
            lines[judgement.instance] = judgement.to_json()
            text = "".join(lines[name] for name in sorted(lines))
            try:
                path.parent.mkdir(parents=True, exist_ok=True)
                # Without the time, so that equal judgements are equal files.
                write_atomically(path, gzip.compress(text.encode(), mtime=0))
            except OSError as error:
                raise cannot_write(path, error) from error

        return keep

    def runs(self) -> list[RunLabel]:
        """Return all runs that there are judgements of, in order.

        Raises:
            InstancesError: A file is damaged.
        """
        first = (next(iter(_read(path)), None) for path in self._judged.glob(f"*{_SUFFIX}"))
        return sorted(judgement.run for judgement in first if judgement is not None)

    def check_archives(self, runs: Sequence[RunLabel]) -> None:
        """Check that there is one archive for each task, method, seed and sample.

        Args:
            runs: Those that are to stand in one report.

        Raises:
            InstancesError: Two of them are of the same task, method, seed and sample, or one of
                them and another one that has been judged.
        """
        first: dict[str, RunLabel] = {}
        for run in runs:
            other = first.setdefault(run.place, run)
            if other != run:
                judged = [str(path) for path in map(self._path, (other, run)) if path.exists()]
                advice = (
                    f"keep one of them, and delete what was judged of the other "
                    f"({' or '.join(judged)})"
                    if judged
                    else "name one of them alone"
                )
                raise _two_archives(run.place, other.name, run.name, advice)
            for path in sorted(self._judged.glob(f"{run.place}.*{_SUFFIX}")):
                if path != self._path(run):
                    name = path.name.removesuffix(_SUFFIX)
                    advice = f"delete {path}, or choose another folder with --out"
                    raise _two_archives(
                        run.place, run.name, f"{name}, which was judged before,", advice
                    )

    @cached_property
    def _declared(self) -> str:
        return fingerprint(self.cap)

    @property
    def _judged(self) -> Path:
        return self.out / "judged"

    def _path(self, run: RunLabel) -> Path:
        return self._judged / f"{run.name}{_SUFFIX}"

    def _all(self, run: RunLabel) -> dict[str, Judgement]:
        path = self._path(run)
        judgements = _read(path) if path.exists() else []
        for judgement in judgements:
            if judgement.run != run:
                raise InstancesError(
                    f"Expected what {run.name} came to in {path}, but got what "
                    f"{judgement.run.name} did; delete the file, and it is judged again."
                )
        return {judgement.instance: judgement for judgement in judgements}


def cannot_write(path: Path, error: OSError) -> InstancesError:
    """Return the error of a file of the folder that cannot be written."""
    return InstancesError(
        f"Expected to write {path}, but that failed ({error.strerror or error}); make space or "
        "choose another folder with --out."
    )


def _two_archives(place: str, one: str, other: str, advice: str) -> InstancesError:
    return InstancesError(
        f"Expected one archive of {place}, but there are {one} and {other} of the same task, "
        f"method, seed and sample; {advice}."
    )


def _read(path: Path) -> list[Judgement]:
    try:
        lines = gzip.decompress(path.read_bytes()).decode().splitlines()
    except (OSError, EOFError, zlib.error, UnicodeDecodeError) as error:
        raise InstancesError(
            f"Expected judgements in {path}, but it cannot be read ({error}); delete the file, and "
            "they are made again."
        ) from error
    try:
        return [Judgement.from_json(line) for line in lines]
    except InstancesError as error:
        raise InstancesError(f"{path}: {error}") from error
