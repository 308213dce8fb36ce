"""The rows of a run's `metrics.csv`, read back."""

import csv
from pathlib import Path
from typing import Any, get_type_hints

from lqd_search.runs.metrics import Metrics
from lqd_search.runs.run_folder_error import RunFolderError

_TYPES = get_type_hints(Metrics)


def read_metrics(path: Path) -> tuple[Metrics, ...]:
    """Return a run's figures over time, one for each generation.

    Args:
        path: Its `metrics.csv`.

    Raises:
        RunFolderError: The file is missing or damaged.
    """
    try:
        with path.open(newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file, strict=True))
        return tuple(_row(cells) for cells in rows)
    except (OSError, ValueError, KeyError, TypeError, csv.Error) as error:
        raise RunFolderError(
            f"Expected a row of figures for each generation in {path}, but it cannot be read "
            f"({type(error).__name__}: {error}); restore the file, or run the search again."
        ) from error


def _row(cells: dict[str, str]) -> Metrics:
    return Metrics(**{name: _value(_TYPES[name], cells[name]) for name in _TYPES})


def _value(kind: Any, text: str) -> Any:
    if kind == float | None:
        return float(text) if text else None
    return kind(text)
