"""A run whose archive is judged by instances."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from hashlib import blake2b
from pathlib import Path

from lqd_envs import LQDError, Task, get_task
from lqd_search.runs.run_folder import ARCHIVE, RunFolder
from lqd_search.runs.stored_archive import StoredArchive


class InstancesError(LQDError):
    """Runs or judgements that do not go together, or cannot be read."""


@dataclass(frozen=True, order=True)
class RunLabel:
    """Which run it is, wherever its folder lies.

    Attributes:
        task: Id of the task.
        method: Name of the method.
        evaluations: Evaluations that it spent.
        seed: Seed of the search.
        sample: Which sample of the model's replies steered it.
        digest: Fingerprint of its archive.
    """

    task: str
    method: str
    evaluations: int
    seed: int
    sample: int
    digest: str

    @property
    def name(self) -> str:
        """What its folder of judgements is called."""
        short = self.task.rpartition("/")[2].partition("-")[0].lower()
        return f"{short}.{self.method}.seed-{self.seed}.sample-{self.sample}.{self.digest}"

    @classmethod
    def read(cls, path: Path) -> "RunLabel":
        """Return which run a folder holds, without its archive in memory.

        Raises:
            LQDError: The folder is none, is damaged, or its run is not finished.
        """
        config = RunFolder.open(path).config()
        try:
            content = (path / ARCHIVE).read_bytes()
        except OSError as error:
            raise InstancesError(
                f"Expected a finished run in {path}, but its {ARCHIVE} cannot be read "
                f"({error.strerror or error}); let the run end first."
            ) from error
        return cls(
            task=config.task,
            method=config.method,
            evaluations=config.evaluations,
            seed=config.seed,
            sample=config.sample,
            digest=blake2b(content, digest_size=4).hexdigest(),
        )


@dataclass(frozen=True, eq=False)
class JudgedRun:
    """A finished run.

    Attributes:
        label: Which one.
        task: Its task.
        archive: What it puts out.
    """

    label: RunLabel
    task: Task
    archive: StoredArchive = field(repr=False)

    @classmethod
    def read(cls, path: Path) -> "JudgedRun":
        """Read a run folder.

        Raises:
            LQDError: The folder is none, is damaged, or its run is not finished.
        """
        label = RunLabel.read(path)
        return cls(label, get_task(label.task), RunFolder.open(path).archive())


def check_labels(labels: Sequence[RunLabel]) -> None:
    """Check that runs may stand in one table.

    Raises:
        InstancesError: One is there twice, or runs of a method on a task spent different numbers
            of evaluations.
    """
    spent: dict[tuple[str, str], int] = {}
    for i, label in enumerate(labels):
        if label in labels[:i]:
            raise InstancesError(
                f"Expected different runs, but {label.name} is there twice; name it once."
            )
        first = spent.setdefault((label.task, label.method), label.evaluations)
        if first != label.evaluations:
            raise InstancesError(
                f"Expected runs of {label.method} on {label.task} with equal evaluations, but got "
                f"{first:,} and {label.evaluations:,}; give each scale a folder of its own."
            )
