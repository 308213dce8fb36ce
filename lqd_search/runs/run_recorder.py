"""Writing down a run while it goes on."""

import json
import time
from collections.abc import Callable
from pathlib import Path

from lqd_envs import Task
from lqd_search.methods.fitness_exploration import LanguageDrivenQD
from lqd_search.runs.metrics import Metrics, measure_generation
from lqd_search.pictures import draw_curves, draw_ground_truth, draw_heat_map
from lqd_search.runs.run_folder import ARCHIVE, PICTURES, SUMMARY, RunFolder
from lqd_search.runs.stored_archive import StoredArchive
from lqd_search.runs.success_archive import SuccessArchive
from lqd_search.runs.summary import summarize
from lqd_search.runs.tally import Tally
from lqd_search.evaluation.values import Refusal, Values

OnGeneration = Callable[[Metrics], None]
"""Is told the figures of each generation."""
OnRefusal = Callable[[Refusal, int], None]
"""Is told of each refusal of a new kind, with the number of the motion (its evaluation)."""


class RunRecorder:
    """Keeps the figures of a run in its folder, generation by generation.

    Args:
        folder: The run's folder.
        task: The run's task.
        method: The method whose archive is measured.
        on_generation: Called after each generation.
        on_refusal: Called when a functional's value is refused for a reason not met before.
    """

    def __init__(
        self,
        folder: RunFolder,
        *,
        task: Task,
        method: LanguageDrivenQD,
        on_generation: OnGeneration,
        on_refusal: OnRefusal,
    ) -> None:
        self._folder = folder
        self._task = task
        self._method = method
        self._on_generation = on_generation
        self._on_refusal = on_refusal
        self._tally = Tally()
        self._metrics: list[Metrics] = []
        self._began = time.monotonic()

    def observe(self, stage: str, values: Values) -> None:
        """Take down a generation.

        Args:
            stage: What the method was doing.
            values: What the generation came to.
        """
        first = self._tally.evaluations
        for refusal in self._tally.add(values):
            self._on_refusal(refusal, first + refusal.first_motion)
        metrics = measure_generation(
            generation=len(self._metrics) + 1,
            stage=stage,
            tally=self._tally,
            archive=self._method.archive,
            successes=self._successes(),
            seconds=time.monotonic() - self._began,
        )
        self._metrics.append(metrics)
        self._folder.append_metrics(metrics)
        self._on_generation(metrics)

    def finish(self) -> tuple[Path, ...]:
        """Write archive, pictures and figures.

        Returns:
            The pictures.
        """
        archive, successes = StoredArchive.of(self._method.archive), self._successes()
        self._folder.write(ARCHIVE, archive.to_bytes())
        pictures = self._draw(archive, successes)
        summary = summarize(
            config=self._folder.config(),
            method=self._method,
            tally=self._tally,
            successes=successes,
            seconds=time.monotonic() - self._began,
        )
        # Last, since a run is finished when it has a summary.
        self._folder.write(SUMMARY, (json.dumps(summary, indent=2) + "\n").encode())
        return pictures

    def _successes(self) -> SuccessArchive:
        return SuccessArchive.of(self._method.output(), ground_truth=self._task.ground_truth)

    def _draw(self, archive: StoredArchive, successes: SuccessArchive) -> tuple[Path, ...]:
        title = f"{self._task.id}: {self._task.instruction}"
        pictures = {
            "curves.png": draw_curves(self._metrics, title=title),
            "ground_truth.png": draw_ground_truth(self._task.ground_truth, successes),
        }
        for name, grid in archive.grids.items():
            pictures[f"grid.{name}.png"] = draw_heat_map(name, grid, fields=archive.fields)
        return tuple(
            self._folder.write(f"{PICTURES}/{name}", content) for name, content in pictures.items()
        )
