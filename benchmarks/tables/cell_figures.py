"""The figures of a finished cell: all that the tables need, in one small JSON file."""

import json
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.tables.cell import Cell
from lqd_envs import LQDError
from lqd_search.methods.steering import EXPERT
from lqd_search.runs.json_form import FormError, check_form, known_keys


class CellError(LQDError):
    """A cell's figures are damaged, or are not those that were expected."""


@dataclass(frozen=True)
class Verdicts:
    """How many motions or elites which conditions approved.

    Attributes:
        both: The inferred condition and the expert's.
        inferred_only: Only the inferred one.
        expert_only: Only the expert's.
        neither: None of them.
    """

    both: int
    inferred_only: int
    expert_only: int
    neither: int

    @classmethod
    def of(cls, inferred: NDArray[np.bool_], expert: NDArray[np.bool_]) -> "Verdicts":
        """Count (n,) verdicts of the two conditions on the same motions or elites."""
        return cls(
            both=int((inferred & expert).sum()),
            inferred_only=int((inferred & ~expert).sum()),
            expert_only=int((~inferred & expert).sum()),
            neither=int((~inferred & ~expert).sum()),
        )


@dataclass(frozen=True)
class Curve:
    """How a cell went, one entry a generation.

    Attributes:
        evaluations: Evaluations so far.
        success_archive_size: As of the whole cell, of the archive at that time.
        ground_truth_cells: The same.
        outcomes: As of the whole cell, so far.
        outcome_cells: The same.
    """

    evaluations: tuple[int, ...]
    success_archive_size: tuple[int, ...]
    ground_truth_cells: tuple[int, ...]
    outcomes: tuple[int, ...]
    outcome_cells: tuple[int, ...]


@dataclass(frozen=True)
class CellFigures:
    """The figures of a finished cell.

    Attributes:
        task: Short name of the task.
        method: Name of the method, or of a variant of `ours`.
        seed: Seed of the search.
        sample: Which recorded sample of the model's replies.
        evaluations: Evaluations spent.
        batch_size: Solutions in a generation.
        switches: The switches of `ours_plus` that were on, in alphabetical order.
        functionals: Digest of the functionals of its run; empty where the expert steers.
        capacity: The most elites that its final archive could hold.
        steering: Whose functionals it was told the values of, a value of `STEERING`.
        valid: Motions that were judged.
        rejected: Motions that failed before simulation.
        discarded: Motions that failed in simulation.
        inferred_successes: Motions that the inferred condition approved.
        expert_successes: Motions that the expert's condition approved.
        motions: The verdicts on the valid motions.
        elites: The verdicts on the distinct elites of the final archive.
        archive_size: Distinct elites of the final archive.
        success_archive_size: Those that the expert's condition approves.
        ground_truth_cells: Cells of the ground-truth grid that these fill.
        ground_truth_outside: Those of them that are outside the grid.
        outcomes: Distinct successes of the whole run, by the expert's condition.
        outcome_cells: Cells of the ground-truth grid that these fill.
        outcomes_outside: Those of them that are outside the grid.
        chosen_fitness: The fitness that the exploration kept; None: there was none.
        curve: How it went.
        seconds: How long it took, in s, on one thread beside the other cells.
        model: The model that wrote the functionals.
        provenance: How its replies were taken.
        machine: What it ran on.
        commit: Of the sources, with a `+` where they were changed; empty where there is no git. All
            of them, where it was gone on with at another one.
        versions: Of Python and of every package that can change a result.
    """

    task: str
    method: str
    seed: int
    sample: int
    evaluations: int
    batch_size: int
    switches: tuple[str, ...]
    functionals: str
    capacity: int
    steering: str
    valid: int
    rejected: int
    discarded: int
    inferred_successes: int
    expert_successes: int
    motions: Verdicts
    elites: Verdicts
    archive_size: int
    success_archive_size: int
    ground_truth_cells: int
    ground_truth_outside: int
    outcomes: int
    outcome_cells: int
    outcomes_outside: int
    chosen_fitness: str | None
    curve: Curve
    seconds: float
    model: str
    provenance: str
    machine: str
    commit: str
    versions: dict[str, str]

    @property
    def cell(self) -> Cell:
        """The cell."""
        return Cell(self.task, self.method, self.seed, self.sample)

    @property
    def inferred(self) -> bool:
        """Whether it was judged by an inferred condition, and not by the expert's."""
        return self.steering != EXPERT

    def to_json(self) -> str:
        """Return the text of the cell's file."""
        return json.dumps(asdict(self)) + "\n"

    @classmethod
    def from_json(cls, text: str) -> "CellFigures":
        """Return the figures that were written.

        Raises:
            CellError: The text is not JSON, or has another form.
        """
        try:
            data: Any = json.loads(text)
            check_form(data, cls)
        except (ValueError, FormError) as error:
            raise CellError(
                f"Expected the figures of a cell, but they cannot be read ({error}); delete the "
                "file, and the cell is run again."
            ) from error
        curve = {name: tuple(column) for name, column in data["curve"].items()}
        parts = {
            **{
                name: Verdicts(**known_keys(data[name], Verdicts)) for name in ("motions", "elites")
            },
            "curve": Curve(**known_keys(curve, Curve)),
            "switches": tuple(data["switches"]),
        }
        return cls(**{**known_keys(data, cls), **parts})
