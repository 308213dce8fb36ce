"""What is worth knowing about functions that pass their checks."""

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from lqd_llm.check import Candidate, CheckOutcome

_NEVER = -1.0


def remarks(checked: Iterable[tuple[Candidate, CheckOutcome]]) -> tuple[str, ...]:
    """Return one sentence for each function of a set that adds little to it.

    That is a fitness, a quantity or a direct descriptor that gives the same for all example
    motions, a timestamp that is defined for none of them, and a timestamp that picks the same
    moment of each as one before it. They can be used all the same: other motions may differ.

    Args:
        checked: The functions that are used, in order, each with the outcome of its check; one
            without values is passed over.
    """
    pairs = [(its, outcome.values) for its, outcome in checked if outcome.values is not None]
    sentences = [_unvarying(its, values) for its, values in pairs]
    timestamps = [(its, values) for its, values in pairs if its.entry == "timestamp"]
    return tuple(sentence for sentence in [*sentences, *_same(timestamps)] if sentence)


def _unvarying(candidate: Candidate, values: NDArray[np.float64]) -> str | None:
    motions = f"all {len(values)} example motions"
    numbers = "the same number" if candidate.entry == "fitness" else "the same numbers"
    match candidate.entry:
        case "timestamp":
            if np.all(values == _NEVER):
                return (
                    f"{_named(candidate)} is defined on none of the {len(values)} example motions."
                )
        case "quantity":
            if _constant(values.reshape(-1, values.shape[-1])):
                where = "at the first, the middle and the last moment of"
                return f"{_named(candidate)} gives {numbers} {where} {motions}."
        case "fitness" | "descriptor":
            if _constant(values):
                return f"{_named(candidate)} gives {numbers} for {motions}."
    return None


def _same(timestamps: Sequence[tuple[Candidate, NDArray[np.float64]]]) -> list[str]:
    first: dict[bytes, str] = {}
    sentences = []
    for candidate, moments in timestamps:
        name = candidate.source.name
        before = first.setdefault(moments.tobytes(), name)
        if before != name and not np.all(moments == _NEVER):
            sentences.append(
                f"The timestamps {before!r} and {name!r} pick the same moment of each of "
                f"the {len(moments)} example motions."
            )
    return sentences


def _constant(rows: NDArray[np.float64]) -> bool:
    defined = rows[~np.isnan(rows[:, 0])]
    return bool(len(defined)) and np.array_equal(
        defined, np.broadcast_to(defined[0], defined.shape), equal_nan=True
    )


def _named(candidate: Candidate) -> str:
    if candidate.kind == "direct":
        return f"The direct {candidate.entry}"
    return f"The {candidate.entry} {candidate.source.name!r}"
