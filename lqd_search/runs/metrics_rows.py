"""The rows of a run's `metrics.csv`, read back."""

import csv
import math
from collections.abc import Collection, Sequence
from pathlib import Path
from typing import Any, get_type_hints

from lqd_search.runs.metrics import Metrics
from lqd_search.runs.run_folder_error import RunFolderError

_TYPES = get_type_hints(Metrics)


def read_metrics(path: Path, *, evaluations: int | None = None) -> tuple[Metrics, ...]:
    """Return a run's figures over time, one for each generation.

    Args:
        path: Its `metrics.csv`.
        evaluations: Evaluations of the finished run, as its summary has them, which the last row
            must have too; None: whatever rows there are will do.

    Raises:
        RunFolderError: The file is missing or damaged.
    """
    try:
        with path.open(newline="", encoding="utf-8") as file:
            table = csv.DictReader(file, strict=True)
            _check_names(table.fieldnames or ())
            rows = tuple(map(_row, table))
        _check_last(rows, evaluations)
        return rows
    except (OSError, ValueError, KeyError, TypeError, csv.Error) as error:
        raise RunFolderError(
            f"Expected a row of figures for each generation in {path}, but it cannot be read "
            f"({type(error).__name__}: {error}); restore the file, or run the search again."
        ) from error


def _check_names(names: Collection[str]) -> None:
    missing = [name for name in _TYPES if name not in names]
    if missing:
        raise ValueError(f"no column {', '.join(missing)}")


def _check_last(rows: Sequence[Metrics], evaluations: int | None) -> None:
    last = rows[-1].evaluations if rows else 0
    if evaluations is not None and last != evaluations:
        raise ValueError(f"its rows end after {last} of {evaluations} evaluations")


def _row(cells: dict[str, str]) -> Metrics:
    return Metrics(**{name: _value(_TYPES[name], cells[name]) for name in _TYPES})


def _value(kind: Any, text: str) -> Any:
    if kind == float | None and not text:
        return None
    if kind in (float, float | None):
        return _finite(text)
    return kind(text)


def _finite(text: str) -> float:
    number = float(text)
    if not math.isfinite(number):
        raise ValueError(f"no finite number: {text!r}")
    return number
