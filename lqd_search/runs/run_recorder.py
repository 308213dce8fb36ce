"""Writing down a run while it goes on, so that it can be killed and gone on with."""

import json
import time
from collections.abc import Callable
from pathlib import Path

from lqd_envs import Task
from lqd_search.evaluation.descriptor_report import report_descriptors
from lqd_search.evaluation.values import Refusal, StoppedFunction
from lqd_search.loop import Generation
from lqd_search.pictures import draw_curves, draw_ground_truth, draw_heat_map
from lqd_search.runs.metrics import Metrics, measure_generation
from lqd_search.runs.run_folder import ARCHIVE, OUTCOMES, PICTURES, SUMMARY, RunFolder
from lqd_search.runs.run_state import RunState
from lqd_search.runs.stored_archive import StoredArchive
from lqd_search.runs.success_archive import SuccessArchive
from lqd_search.runs.summary import summarize

OnGeneration = Callable[[Metrics], None]
"""Is told the figures of each generation."""
OnRefusal = Callable[[Refusal, int], None]
"""Is told of each refusal of a new kind, with the number of the motion (its evaluation)."""
OnStopped = Callable[[StoppedFunction], None]
"""Is told of each functional that is stopped."""


class RunRecorder:
    """Keeps a run in its folder, generation by generation, and writes its results at the end.

    After each generation its new outcomes, then the checkpoint, then the row of `metrics.csv` are
    written. Whenever the process ends, the run goes on from the last checkpoint, and what was
    written after it is written again.

    Args:
        folder: The run's folder.
        task: The run's task.
        state: Where the run stands, a new one or that of a checkpoint; it is kept up to date.
        on_generation: Called after each generation.
        on_refusal: Called when a functional's value is refused for a reason not met before.
        on_stopped: Called when a functional is stopped.

    Raises:
        RunFolderError: The folder cannot be written.
        OutcomeError: The outcomes of the generations so far are missing or damaged.
    """

    def __init__(
        self,
        folder: RunFolder,
        *,
        task: Task,
        state: RunState,
        on_generation: OnGeneration,
        on_refusal: OnRefusal,
        on_stopped: OnStopped,
    ) -> None:
        self._folder = folder
        self._task = task
        self._state = state
        self._on_generation = on_generation
        self._on_refusal = on_refusal
        self._on_stopped = on_stopped
        self._outcomes = folder.state.read_outcomes(
            len(state.metrics), ground_truth=task.ground_truth
        )
        self._earlier, self._began = state.seconds, time.monotonic()
        folder.metrics.write(state.metrics)

    def observe(self, generation: Generation) -> None:
        """Take down a generation."""
        state, values = self._state, generation.values
        for refusal in state.tally.add(values):
            self._on_refusal(refusal, generation.evaluation + refusal.first_motion)
        state.stopped += values.stopped
        for stopped in values.stopped:
            self._on_stopped(stopped)
        if state.report is None:
            state.report = report_descriptors(values.valid_measures)
        news = self._outcomes.add(generation.solutions, values, evaluation=generation.evaluation)
        state.seconds = self._seconds()
        metrics = measure_generation(
            generation=len(state.metrics) + 1,
            stage=generation.stage,
            tally=state.tally,
            archive=state.method.archive,
            successes=self._successes(),
            outcomes=self._outcomes.figures,
            seconds=state.seconds,
        )
        state.metrics.append(metrics)
        self._folder.state.write_outcomes(metrics.generation, news)
        self._folder.state.save(state)
        self._folder.metrics.append(metrics)
        self._on_generation(metrics)

    def finish(self) -> tuple[Path, ...]:
        """Write archive, outcomes, pictures and figures, and remove the checkpoint.

        Returns:
            The pictures.
        """
        archive, successes = StoredArchive.of(self._state.method), self._successes()
        self._folder.write(ARCHIVE, archive.to_bytes())
        self._folder.write(OUTCOMES, self._outcomes.to_bytes())
        pictures = self._draw(archive, successes)
        self._state.seconds = self._seconds()
        summary = summarize(
            config=self._folder.config(),
            state=self._state,
            successes=successes,
            outcomes=self._outcomes.figures,
        )
        # As a whole, since rows that were only appended need not be on the disk yet.
        self._folder.metrics.write(self._state.metrics)
        # Last, since a run is finished when it has a summary.
        self._folder.write(SUMMARY, (json.dumps(summary, indent=2) + "\n").encode())
        self._folder.state.remove()
        return pictures

    def _seconds(self) -> float:
        return self._earlier + time.monotonic() - self._began

    def _successes(self) -> SuccessArchive:
        output = self._state.method.output()
        return SuccessArchive.of(output, ground_truth=self._task.ground_truth)

    def _draw(self, archive: StoredArchive, successes: SuccessArchive) -> tuple[Path, ...]:
        title = f"{self._task.id}: {self._task.instruction}"
        pictures = {
            "curves.png": draw_curves(self._state.metrics, title=title),
            "ground_truth.png": draw_ground_truth(self._task.ground_truth, successes),
        }
        for name, grid in archive.grids.items():
            pictures[f"grid.{name}.png"] = draw_heat_map(name, grid, fields=archive.fields)
        return tuple(
            self._folder.write(f"{PICTURES}/{name}", content) for name, content in pictures.items()
        )
