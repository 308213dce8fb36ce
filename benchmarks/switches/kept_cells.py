"""The runs with switches that are kept in a folder."""

import json
from pathlib import Path
from typing import Any

from benchmarks.switches.switch_cell import SwitchCell
from lqd_envs import LQDError
from lqd_search.runs.json_form import FormError, check_form, known_keys


class SwitchesError(LQDError):
    """A switch is unknown, or a kept run cannot be compared with the others."""


def load(out: Path, *, evaluations: int, batch_size: int) -> list[SwitchCell]:
    """Return the runs that are kept in a folder.

    Raises:
        SwitchesError: One is damaged, or of another budget or generation.
    """
    cells = [_read(path) for path in sorted(out.glob("*.json"))]
    for cell in cells:
        if (cell.evaluations, cell.batch_size) != (evaluations, batch_size):
            raise SwitchesError(
                f"Expected runs of {evaluations} evaluations, {batch_size} a generation, in {out}, "
                f"but that of {cell.switches} on {cell.task} has {cell.evaluations} and "
                f"{cell.batch_size}; give each budget a folder of its own with --out."
            )
    return cells


def _read(path: Path) -> SwitchCell:
    try:
        data: Any = {"commit": "", **json.loads(path.read_text())}
        check_form(data, SwitchCell)
    except (OSError, ValueError, TypeError, FormError) as error:
        raise SwitchesError(
            f"Expected the figures of a run in {path}, but they cannot be read ({error}); delete "
            "the file, and it is run again."
        ) from error
    return SwitchCell(**known_keys(data, SwitchCell))
