"""The outcomes of a run on disk: one segment for each generation, and one file at its end."""

import io
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from lqd_envs import LQDError
from lqd_envs.atomic_file import write_atomically
from lqd_search.evaluation.motion_evaluator import DIGEST, EXPERT, GROUND_TRUTH
from lqd_search.runs.npz_columns import ColumnError, column_of, read_columns

Outcomes: TypeAlias = Mapping[str, NDArray[Any]]
"""Columns of k rows each, in the order of their evaluation: `solution` (k, dim) float64,
`evaluation` int64, `success` bool (the run's own condition), `expert` bool, `ground_truth` (k, d)
float64, `digest` uint64, `fitness/<name>` float64 and `measures/<descriptor>` (k, d) float64, NaN
where undefined."""

FITNESS, MEASURES = "fitness/", "measures/"

_FIXED: Mapping[str, tuple[type[np.generic], int]] = {
    "solution": (np.float64, 2),
    "evaluation": (np.int64, 1),
    "success": (np.bool_, 1),
    EXPERT: (np.bool_, 1),
    GROUND_TRUTH: (np.float64, 2),
    DIGEST: (np.uint64, 1),
}


class OutcomeError(LQDError):
    """Outcomes that do not fit together, or that cannot be written or read."""


def write_segment(folder: Path, generation: int, outcomes: Outcomes) -> Path:
    """Write what `OutcomeArchive.add` returned, as `<generation>.npz`, six digits, uncompressed.

    Args:
        folder: Where the segments are; it is made if it is not there.
        generation: Number of the generation, from 1.
        outcomes: What is new in it; no rows, if nothing is.

    Returns:
        The file.

    Raises:
        OutcomeError: It cannot be written.
    """
    path = _segment(folder, generation)
    buffer = io.BytesIO()
    np.savez(buffer, allow_pickle=False, **outcomes)
    try:
        folder.mkdir(exist_ok=True)
        write_atomically(path, buffer.getbuffer())
    except OSError as error:
        raise OutcomeError(
            f"Expected to write the outcomes {path}, but that failed ({error.strerror or error}); "
            "make space or make the folder writable, and resume the run."
        ) from error
    return path


def read_segments(folder: Path, *, upto_generation: int) -> list[Outcomes]:
    """Read the segments of a run that is resumed.

    Those of later generations, which will be evaluated again, are left alone.

    Args:
        folder: Where the segments are.
        upto_generation: The last generation that is in the checkpoint; 0: none.

    Returns:
        The outcomes of the generations 1 to `upto_generation`.

    Raises:
        OutcomeError: A segment is missing, damaged or of another form.
    """
    return [_read(_segment(folder, i)) for i in range(1, upto_generation + 1)]


def to_bytes(outcomes: Outcomes) -> bytes:
    """Return the contents of one compressed npz file; equal outcomes give equal bytes."""
    buffer = io.BytesIO()
    np.savez_compressed(buffer, allow_pickle=False, **outcomes)
    return buffer.getvalue()


def load_outcomes(path: Path) -> Outcomes:
    """Read all outcomes of a run, as `to_bytes` wrote them.

    Raises:
        OutcomeError: The file is missing, damaged or of another form.
    """
    return _read(path)


def join(blocks: Sequence[Outcomes]) -> Outcomes:
    """Return the outcomes of several blocks of a run, one after the other.

    Args:
        blocks: At least one, all of one form, as `check_same_form` says.
    """
    return {name: np.concatenate([block[name] for block in blocks]) for name in blocks[0]}


def check_same_form(one: Outcomes, other: Outcomes) -> None:
    """Check that two blocks of a run have the same columns.

    Raises:
        OutcomeError: They have not.
    """
    forms = [{name: c.shape[1:] for name, c in block.items()} for block in (one, other)]
    if forms[0] != forms[1]:
        places = [name for name in {**forms[0], **forms[1]} if _differ(name, *forms)]
        raise OutcomeError(
            "Expected the same columns in every generation's outcomes, but they differ in "
            f"{', '.join(places)}; they are those of different runs."
        )


def check_order(one: Outcomes, other: Outcomes) -> None:
    """Check that the evaluations of a block come after those of the one before it.

    Raises:
        OutcomeError: They do not.
    """
    last, first = one["evaluation"][-1:], other["evaluation"][:1]
    if len(last) and len(first) and first[0] <= last[0]:
        raise OutcomeError(
            f"Expected outcomes of evaluations after {last[0]}, but got {first[0]}; tell each "
            "generation once, in order."
        )


def check_outcomes(outcomes: Outcomes) -> None:
    """Check that outcomes have the columns that they must have.

    Raises:
        OutcomeError: One is missing or of another form.
    """
    try:
        _check(outcomes)
    except ColumnError as error:
        raise OutcomeError(
            f"Expected outcomes as a MotionEvaluator finds them, but {error}; convert the column."
        ) from error


def _differ(name: str, one: Mapping[str, Any], other: Mapping[str, Any]) -> bool:
    return one.get(name) != other.get(name)


def _segment(folder: Path, generation: int) -> Path:
    return folder / f"{generation:06d}.npz"


def _read(path: Path) -> Outcomes:
    try:
        columns = read_columns(path)
        _check(columns)
    except ColumnError as error:
        raise OutcomeError(
            f"Expected outcomes in {path}, but they cannot be read ({error}); restore the file, or "
            "begin the run again from its start."
        ) from error
    return columns


def _check(columns: Outcomes) -> None:
    for name, (dtype, ndim) in _FIXED.items():
        column_of(columns, name, dtype=dtype, ndim=ndim)
    for name, column in columns.items():
        if name.startswith(FITNESS):
            column_of(columns, name, dtype=np.float64, ndim=1)
        elif name.startswith(MEASURES):
            column_of(columns, name, dtype=np.float64, ndim=2)
        elif name not in _FIXED:
            raise ColumnError(f"expected no column {name}")
        if len(column) != len(columns["solution"]):
            raise ColumnError(
                f"expected as many rows in {name} as in solution, got {len(column)} and "
                f"{len(columns['solution'])}"
            )
    if (np.diff(columns["evaluation"], prepend=-1) <= 0).any():
        raise ColumnError("expected numbers that ascend from 0 in evaluation")
    if not (columns["success"] | columns[EXPERT]).all():
        raise ColumnError(f"expected a success in each row by success or {EXPERT}")
