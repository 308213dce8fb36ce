"""The judgements on disk: a small file for each run and instance."""

from dataclasses import dataclass
from pathlib import Path

from benchmarks.instances.judged_run import InstancesError, RunLabel
from benchmarks.instances.judgement import Judgement
from lqd_envs.atomic_file import write_atomically
from lqd_envs.instances import Instance


@dataclass(frozen=True)
class JudgementStore:
    """The folder of judgements, `judged/<run>/<instance>.json`.

    Attributes:
        out: The folder that it is in.
        cap: Most motions that were drawn for simulation; a judgement with another one is none.
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
        return judgement if judgement.cap == self.cap else None

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
        folders = sorted((self.out / "judged").glob("*/"))
        files = (next(iter(sorted(folder.glob("*.json"))), None) for folder in folders)
        return sorted(_read(file).run for file in files if file is not None)

    def _path(self, run: RunLabel, instance: Instance) -> Path:
        return self.out / "judged" / run.name / f"{instance.name}.json"


def _read(path: Path) -> Judgement:
    try:
        return Judgement.from_json(path.read_text())
    except InstancesError as error:
        raise InstancesError(f"{path}: {error}") from error
