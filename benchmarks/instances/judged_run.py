"""A run whose archive is judged by instances."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from hashlib import blake2b
from pathlib import Path

from lqd_envs import LQDError, Task, get_task
from lqd_search.methods.by_name import METHODS
from lqd_search.runs.run_folder import ARCHIVE, RunFolder
from lqd_search.runs.stored_archive import StoredArchive

_ALIKE = {
    "evaluations": "evaluations",
    "batch_size": "sizes of a generation",
    "failure_competition": "failure competition",
}
_ALIKE_IN_A_METHOD = {"switches": "switches"}


class InstancesError(LQDError):
    """Runs or judgements that do not go together, or cannot be read."""


@dataclass(frozen=True, order=True)
class RunLabel:
    """Which run it is, wherever its folder lies.

    Attributes:
        task: Id of the task.
        method: Name of the method.
        evaluations: Evaluations that it spent.
        batch_size: Solutions in a generation.
        failure_competition: How two failures competed for a cell.
        switches: The switches of `ours_plus` that were on, in alphabetical order.
        seed: Seed of the search.
        sample: Which sample of the model's replies steered it.
        digest: Fingerprint of its archive.
    """

    task: str
    method: str
    evaluations: int
    batch_size: int
    failure_competition: str
    switches: tuple[str, ...]
    seed: int
    sample: int
    digest: str

    @property
    def place(self) -> str:
        """Task, method, seed and sample in short: whose place in a table it has."""
        return f"{get_task(self.task).name}.{self.method}.seed-{self.seed}.sample-{self.sample}"

    @property
    def name(self) -> str:
        """What its file of judgements is called, without the suffix."""
        return f"{self.place}.{self.digest}"

    @classmethod
    def read(cls, path: Path) -> "RunLabel":
        """Return which run a folder holds, without its archive in memory.

        Raises:
            LQDError: The folder is none, is damaged, or its run is not finished or of no method.
        """
        config = RunFolder.open(path).config()
        if config.method not in METHODS:
            raise InstancesError(
                f"Expected a run of one of {', '.join(METHODS)} in {path}, but it is of "
                f"{config.method}; leave it out."
            )
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
            batch_size=config.batch_size,
            failure_competition=config.failure_competition,
            switches=config.switches,
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
        InstancesError: One is there twice; runs on a task, whatever their methods, differ in
            evaluations, in the size of a generation or in how failures competed; or runs of a
            method on it in their switches.
    """
    of_task: dict[str, RunLabel] = {}
    of_method: dict[tuple[str, str], RunLabel] = {}
    for i, label in enumerate(labels):
        if label in labels[:i]:
            raise InstancesError(
                f"Expected different runs, but {label.name} is there twice; name it once."
            )
        _check_alike(of_task.setdefault(label.task, label), label, _ALIKE)
        pair = (label.task, label.method)
        _check_alike(of_method.setdefault(pair, label), label, _ALIKE_IN_A_METHOD)


def _check_alike(one: RunLabel, other: RunLabel, names: Mapping[str, str]) -> None:
    for name, called in names.items():
        first, second = getattr(one, name), getattr(other, name)
        if first != second:
            raise InstancesError(
                f"Expected runs on {one.task} with equal {called}, but {one.name} has "
                f"{_text(first)} and {other.name} has {_text(second)}; compare them apart, each "
                "kind in a folder of its own with --out."
            )


def _text(value: int | str | tuple[str, ...]) -> str:
    return ("+".join(value) or "none") if isinstance(value, tuple) else str(value)
