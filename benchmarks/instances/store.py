"""The judgements on disk: a small file for each run and instance."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from benchmarks.instances.fingerprint import fingerprint
from benchmarks.instances.judged_run import InstancesError, RunLabel
from benchmarks.instances.judgement import Judgement
from lqd_envs.atomic_file import write_atomically
from lqd_envs.instances import Instance


@dataclass(frozen=True)
class JudgementStore:
    """The folder of judgements, `judged/<run>/<instance>.json`.

    Attributes:
        out: The folder that it is in.
        cap: Most motions that were drawn for simulation. A judgement with another one, or with
            anything else declared otherwise than now, is none.
    """

    out: Path
    cap: int

    def load(self, run: RunLabel, instance: Instance) -> Judgement | None:
        """Return what a run's archive came to in an instance; None: it has not been judged.

        Raises:
            InstancesError: The file is damaged, or that of another run or instance.
        """
        path = self._path(run, instance)
        if not path.exists():
            return None
        judgement = _read(path)
        if (judgement.run, judgement.instance) != (run, instance.name):
            raise InstancesError(
                f"Expected what {run.name} came to in {instance.name} in {path}, but got that of "
                f"{judgement.run.name} in {judgement.instance}; delete the file, and it is judged "
                "again."
            )
        return judgement if judgement.declared == self._declared else None

    def keep(self, judgement: Judgement, instance: Instance) -> None:
        """Write a judgement.

        Raises:
            InstancesError: It cannot be written.
        """
        path = self._path(judgement.run, instance)
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            write_atomically(path, judgement.to_json().encode())
        except OSError as error:
            raise InstancesError(
                f"Expected to write {path}, but that failed ({error.strerror or error}); make space"
                " or choose another folder with --out."
            ) from error

    def runs(self) -> list[RunLabel]:
        """Return all runs that there are judgements of, in order.

        Raises:
            InstancesError: A file is damaged.
        """
        folders = sorted(self._judged.glob("*/"))
        files = (next(iter(sorted(folder.glob("*.json"))), None) for folder in folders)
        return sorted(_read(file).run for file in files if file is not None)

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
                judged = [str(path) for path in map(self._folder, (other, run)) if path.exists()]
                advice = (
                    f"keep one of them, and delete what was judged of the other "
                    f"({' or '.join(judged)})"
                    if judged
                    else "name one of them alone"
                )
                raise _two_archives(run.place, other.name, run.name, advice)
            for folder in sorted(self._judged.glob(f"{run.place}.*")):
                if folder != self._folder(run):
                    advice = f"delete {folder}, or choose another folder with --out"
                    raise _two_archives(
                        run.place, run.name, f"{folder.name}, which was judged before,", advice
                    )

    @cached_property
    def _declared(self) -> str:
        return fingerprint(self.cap)

    @property
    def _judged(self) -> Path:
        return self.out / "judged"

    def _folder(self, run: RunLabel) -> Path:
        return self._judged / run.name

    def _path(self, run: RunLabel, instance: Instance) -> Path:
        return self._folder(run) / f"{instance.name}.json"


def _two_archives(place: str, one: str, other: str, advice: str) -> InstancesError:
    return InstancesError(
        f"Expected one archive of {place}, but there are {one} and {other} of the same task, "
        f"method, seed and sample; {advice}."
    )


def _read(path: Path) -> Judgement:
    try:
        return Judgement.from_json(path.read_text())
    except InstancesError as error:
        raise InstancesError(f"{path}: {error}") from error
