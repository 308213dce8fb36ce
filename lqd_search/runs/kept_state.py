"""What a run that goes on keeps in its folder: a checkpoint, and the outcomes beside it."""

from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from shutil import rmtree

from lqd_envs import GroundTruth
from lqd_search.runs.checkpoint import (
    CheckpointError,
    NoCheckpointError,
    load_checkpoint,
    save_checkpoint,
)
from lqd_search.runs.outcome_archive import OutcomeArchive
from lqd_search.runs.run_folder_error import cannot_write
from lqd_search.runs.run_state import RunState
from lqd_search.runs.stored_outcomes import Outcomes, read_segments, write_segment

_CHECKPOINT, _OUTCOMES = "checkpoint", "checkpoint-outcomes"


@dataclass(frozen=True)
class KeptState:
    """The state of a run that goes on, in the run's folder.

    The outcomes only grow, so that each generation has a file of its own for them, written before
    the checkpoint that counts it.

    Attributes:
        path: The run's folder.
    """

    path: Path

    def save(self, state: RunState) -> None:
        """Write a checkpoint in place of the last one.

        Raises:
            CheckpointError: It cannot be written; the last one is untouched.
        """
        save_checkpoint(self.path / _CHECKPOINT, state)

    def load(self) -> RunState | None:
        """Return the state of the last checkpoint; None: no generation was finished yet.

        Raises:
            CheckpointError: It is damaged or of another form.
        """
        try:
            state = load_checkpoint(self.path / _CHECKPOINT)
        except NoCheckpointError:
            return None
        if not isinstance(state, RunState):
            raise CheckpointError(
                f"Expected the state of a run in {self.path / _CHECKPOINT}, but got a "
                f"{type(state).__name__}; delete it to begin the run again from its start."
            )
        return state

    def remove(self) -> None:
        """Remove what only a run that goes on needs.

        Raises:
            RunFolderError: It cannot be removed.
        """
        try:
            (self.path / _CHECKPOINT).unlink(missing_ok=True)
            # Another process that was asked to go on may see the finished run, and remove it too.
            with suppress(FileNotFoundError):
                rmtree(self.path / _OUTCOMES)
        except OSError as error:
            raise cannot_write(self.path / _CHECKPOINT, error, folder=self.path) from error

    def write_outcomes(self, generation: int, news: Outcomes) -> None:
        """Write the outcomes that are new in a generation.

        Raises:
            OutcomeError: They cannot be written.
        """
        write_segment(self.path / _OUTCOMES, generation, news)

    def read_outcomes(self, generations: int, *, ground_truth: GroundTruth) -> OutcomeArchive:
        """Return the outcomes of the first generations of a run that is not finished.

        Raises:
            OutcomeError: They are missing or damaged.
        """
        segments = read_segments(self.path / _OUTCOMES, upto_generation=generations)
        return OutcomeArchive.from_blocks(segments, ground_truth=ground_truth)
