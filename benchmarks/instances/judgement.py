"""What an archive came to in one instance: all that the tables need, in one small JSON file."""

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.instances.candidates import Candidates
from benchmarks.instances.declared import TRIES
from benchmarks.instances.judged_run import InstancesError, RunLabel
from benchmarks.instances.looked_at import LookedAt
from benchmarks.instances.provenance import Provenance
from lqd_search.runs.json_form import FormError, check_form, known_keys


@dataclass(frozen=True)
class FilterFigures:
    """The figures of the motions that one condition approves.

    Attributes:
        motions: How many there are.
        judged: How many of them were judged, drawn at random.
        solved: How many of those solve the instance.
        first: For each selector, which of its tries is the first to solve it; 0: none of the first.
        subsets: For each selector and each size, in how many of the random subsets one of its first
            k tries solves it, for each k of `TRIES`.
        looked_at: Which motions were looked at, the judged ones and those that selectors choose,
            and which of them solve it.
    """

    motions: int
    judged: int
    solved: int
    first: dict[str, int]
    subsets: dict[str, dict[str, tuple[int, ...]]]
    looked_at: LookedAt

    @property
    def capped(self) -> bool:
        """Whether there are motions that were not judged."""
        return self.judged < self.motions

    @classmethod
    def of(
        cls,
        candidates: Candidates,
        solved: NDArray[np.bool_],
        *,
        judged: NDArray[np.intp],
        evaluation: NDArray[np.int64],
    ) -> "FilterFigures":
        """Return the figures.

        Args:
            candidates: The motions.
            solved: (m,) for each elite of the archive, whether it solves the instance; where it was
                not looked at, it does not matter.
            judged: Those candidates that were judged, whatever a selector says.
            evaluation: (m,) the evaluation numbers of the elites.
        """
        return cls(
            motions=len(candidates.rows),
            judged=len(judged),
            solved=int(solved[judged].sum()),
            first={name: _first(solved[rows]) for name, rows in candidates.picks.items()},
            subsets={
                name: {
                    str(size): tuple(int(solved[rows][:, :k].any(axis=1).sum()) for k in TRIES)
                    for size, rows in by_size.items()
                }
                for name, by_size in candidates.subset_picks.items()
            },
            looked_at=LookedAt.of(candidates.with_picks(judged), solved, evaluation=evaluation),
        )


@dataclass(frozen=True)
class Judgement:
    """What an archive came to in one instance.

    Attributes:
        run: Which run's archive.
        instance: The instance's name.
        cap: Most motions that were drawn for simulation.
        declared: The fingerprint of all that was declared when it was made.
        solved: Whether any motion that was looked at solves the instance.
        different: How many motions, simulated again in the task itself, were not bit for bit what
            the run saw; 0 in instances with dynamics of their own, where none can be compared.
        filters: The figures by filter.
        provenance: What it was made on.
    """

    run: RunLabel
    instance: str
    cap: int
    declared: str
    solved: bool
    different: int
    filters: dict[str, FilterFigures]
    provenance: Provenance

    def to_json(self) -> str:
        """Return the text of its file."""
        plain = asdict(self)
        # JSON's true is no integer to the check of its form.
        plain["solved"] = int(self.solved)
        return json.dumps(plain) + "\n"

    @classmethod
    def from_json(cls, text: str) -> "Judgement":
        """Return the judgement that was written.

        Raises:
            InstancesError: The text is not JSON, or has another form.
        """
        try:
            data: Any = json.loads(text)
            check_form(data, _Form)
            filters = {name: _figures(plain) for name, plain in data["filters"].items()}
        except (ValueError, FormError) as error:
            raise InstancesError(
                f"Expected what an archive came to in an instance, but it cannot be read ({error})"
                "; delete the file, and it is judged again."
            ) from error
        switches = tuple(data["run"]["switches"])
        parts = {
            "run": RunLabel(**{**known_keys(data["run"], RunLabel), "switches": switches}),
            "solved": bool(data["solved"]),
            "filters": filters,
            "provenance": Provenance(**known_keys(data["provenance"], Provenance)),
        }
        return cls(**{**known_keys(data, cls), **parts})


class _Form:
    run: RunLabel
    instance: str
    cap: int
    declared: str
    solved: int
    different: int
    filters: dict[str, FilterFigures]
    provenance: Provenance


def _figures(plain: Mapping[str, Any]) -> FilterFigures:
    subsets = {
        selector: {size: tuple(counts) for size, counts in by_size.items()}
        for selector, by_size in plain["subsets"].items()
    }
    looked_at = LookedAt(**known_keys(plain["looked_at"], LookedAt))
    # Its bits are needed late; that they are whole is seen now.
    looked_at.masks()
    parts = {"subsets": subsets, "looked_at": looked_at}
    return FilterFigures(**{**known_keys(plain, FilterFigures), **parts})


def _first(solved: NDArray[np.bool_]) -> int:
    return int(np.argmax(solved)) + 1 if solved.any() else 0
