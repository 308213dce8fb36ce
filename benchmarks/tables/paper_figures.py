"""The paper's own figures, as far as they are at hand, each with its source."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks.tables.measures import BY_NAME
from benchmarks.tables.study import METHODS, TASKS
from lqd_envs import LQDError
from lqd_search.runs.json_form import FormError, check_form

NOT_AT_HAND = "not at hand"
"""What stands in a table where the paper's figure is not known here."""

_FILE = Path(__file__).with_name("paper_figures.json")


class PaperError(LQDError):
    """The file of the paper's figures has another form."""


@dataclass(frozen=True)
class PaperFigure:
    """A mean and a standard deviation of the paper.

    Attributes:
        task: Short name of the task.
        method: Name of our method that answers to the paper's.
        measure: Name of the measure.
        mean: The mean.
        std: The standard deviation; None: the paper gives none.
        source: Where it stands.
    """

    task: str
    method: str
    measure: str
    mean: float
    std: float | None
    source: str


@dataclass(frozen=True)
class PaperRemark:
    """What is known of the paper's figures otherwise.

    Attributes:
        task: Short name of the task.
        measure: Name of the measure.
        text: What is known, in a sentence.
        source: Where it stands.
    """

    task: str
    measure: str
    text: str
    source: str


@dataclass(frozen=True)
class PaperFigures:
    """The paper's own figures.

    Attributes:
        figures: Those that are at hand.
        remarks: What else is known of them.
    """

    figures: tuple[PaperFigure, ...]
    remarks: tuple[PaperRemark, ...]

    @classmethod
    def load(cls, path: Path = _FILE) -> "PaperFigures":
        """Return what the file holds.

        Raises:
            PaperError: It has another form, or names a task, a method or a measure that is none.
        """
        try:
            data: Any = json.loads(path.read_text())
            check_form(data, cls)
        except (FormError, json.JSONDecodeError) as error:
            raise PaperError(
                f"Expected the paper's figures in {path}, but {error}; correct the file."
            ) from error
        figures = tuple(PaperFigure(**one) for one in data["figures"])
        remarks = tuple(PaperRemark(**one) for one in data["remarks"])
        for one in (*figures, *remarks):
            _check("task", one.task, TASKS)
            _check("measure", one.measure, tuple(BY_NAME))
        for figure in figures:
            _check("method", figure.method, METHODS)
        return cls(figures, remarks)

    def text(self, task: str, method: str, measure: str) -> str:
        """Return the paper's mean ± standard deviation, or that it is not at hand."""
        for one in self.figures:
            if (one.task, one.method, one.measure) == (task, method, measure):
                return f"{one.mean:,g}" if one.std is None else f"{one.mean:,g} ± {one.std:,g}"
        return NOT_AT_HAND


def _check(what: str, name: str, known: Sequence[str]) -> None:
    if name not in known:
        raise PaperError(
            f"Expected a {what} of the paper's figures among {', '.join(known)}, but got {name!r}; "
            "correct it."
        )
