"""Joining the values of successive chunks into those of the whole batch."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lqd_search.evaluation.values import Refusal, StoppedFunction, Values, ValuesError

_Columns = Mapping[str, NDArray[Any]]


def concatenate_values(parts: Sequence[Values]) -> Values:
    """Return what one evaluation of the whole batch would have given, bit for bit.

    A refusal's count is the sum over the chunks, its first motion is an index in the whole batch,
    and the refusals stand in the order in which they first happened. A functional that was stopped
    in several chunks is there once, with the reason of the first.

    Args:
        parts: The values of the batch's chunks, one after another; at least one.

    Raises:
        ValuesError: There is no part, or the parts' columns differ in name, order, dtype or shape.
    """
    if not parts:
        raise ValuesError("Expected the values of at least one chunk, but got none; pass some.")
    return Values(
        valid=np.concatenate([part.valid for part in parts]),
        success=np.concatenate([part.success for part in parts]),
        fitness=_joined("fitness", [part.fitness for part in parts]),
        measures=_joined("measures", [part.measures for part in parts]),
        refusals=_merged(parts),
        passive=_joined("passive", [part.passive for part in parts]),
        perceived=_joined("perceived", [part.perceived for part in parts]),
        stopped=_united(parts),
    )


def _joined(kind: str, parts: Sequence[_Columns]) -> dict[str, NDArray[Any]]:
    first = _forms(parts[0])
    for i, part in enumerate(parts):
        if _forms(part) != first:
            raise ValuesError(
                f"Expected the same {kind} columns in every chunk, but chunk 0 has "
                f"{_listed(first)} and chunk {i} has {_listed(_forms(part))}; evaluate all chunks "
                "in the same way."
            )
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


def _forms(columns: _Columns) -> list[tuple[str, np.dtype[Any], tuple[int, ...]]]:
    return [(name, column.dtype, column.shape[1:]) for name, column in columns.items()]


def _listed(forms: list[tuple[str, np.dtype[Any], tuple[int, ...]]]) -> str:
    named = (f"{name!r} ({dtype}, rows of shape {shape})" for name, dtype, shape in forms)
    return ", ".join(named) or "none"


def _merged(parts: Sequence[Values]) -> tuple[Refusal, ...]:
    # The first motion of a later chunk comes after all of the earlier ones, so that the keys in
    # the order of the chunks are in the order in which one evaluation meets them.
    merged: dict[tuple[str, str, str], Refusal] = {}
    offset = 0
    for part in parts:
        for refusal in part.refusals:
            key = (refusal.kind, refusal.functional, refusal.reason)
            shifted = replace(refusal, first_motion=offset + refusal.first_motion)
            merged[key] = _sum(merged[key], shifted) if key in merged else shifted
        offset += len(part)
    return tuple(merged.values())


def _united(parts: Sequence[Values]) -> tuple[StoppedFunction, ...]:
    united: dict[tuple[str, str], StoppedFunction] = {}
    for stopped in (stopped for part in parts for stopped in part.stopped):
        united.setdefault((stopped.kind, stopped.functional), stopped)
    return tuple(united.values())


def _sum(one: Refusal, other: Refusal) -> Refusal:
    first = min(one.first_motion, other.first_motion)
    return replace(one, count=one.count + other.count, first_motion=first)
