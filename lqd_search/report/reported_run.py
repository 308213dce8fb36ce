"""A finished run as a report shows it: what its folder holds, read once."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain, count
from pathlib import Path

from lqd_envs import Task, get_task
from lqd_search.runs.function_text import FunctionText
from lqd_search.runs.metrics import Metrics
from lqd_search.runs.metrics_rows import read_metrics
from lqd_search.runs.run_config import RunConfig
from lqd_search.runs.run_folder import RunFolder
from lqd_search.runs.stored_archive import StoredArchive
from lqd_search.runs.summary import Summary


@dataclass(frozen=True, eq=False)
class ReportedRun:
    """One run of a report.

    Attributes:
        label: What the report calls it, distinct from the others.
        task: The task that it searched.
        config: What it was asked to do.
        summary: Its figures.
        metrics: Its figures over time.
        archive: What it put out.
        functionals: Its functionals, in order.
    """

    label: str
    task: Task
    config: RunConfig
    summary: Summary
    metrics: tuple[Metrics, ...]
    archive: StoredArchive
    functionals: tuple[FunctionText, ...]

    @classmethod
    def read(cls, folder: Path, *, label: str) -> "ReportedRun":
        """Read the folder of a finished run.

        Raises:
            LQDError: There is no finished run, a part of it is damaged, or its task is unknown.
        """
        run = RunFolder.open(folder)
        config, summary = run.config(), run.summary()
        return cls(
            label=label,
            task=get_task(config.task),
            summary=summary,
            config=config,
            metrics=read_metrics(run.metrics.path, evaluations=summary["evaluations"]),
            archive=run.archive(),
            functionals=run.functionals(),
        )


def labels_of(folders: Sequence[Path]) -> tuple[str, ...]:
    """Return what a report calls the runs in these folders: their names, numbered where equal."""
    labels: list[str] = []
    for folder in folders:
        # The name alone: from wherever it is called, the report is the same.
        name = folder.absolute().resolve().name or "run"
        numbered = (f"{name} ({number})" for number in count(2))
        labels.append(next(label for label in chain([name], numbered) if label not in labels))
    return tuple(labels)
