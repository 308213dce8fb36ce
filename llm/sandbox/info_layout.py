"""How the columns of a batch of motions become the infos that functions are given."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray


class InfoKind(StrEnum):
    """What one key of an info holds."""

    VECTOR = "vector"
    """A tuple of 3 floats; its column is (N, T, 3) float64."""
    FLAG = "flag"
    """A bool; its column is (N, T) bool."""
    FLAGS = "flags"
    """A dictionary name → bool; its column is (N, T, names) bool."""
    NUMBERS = "numbers"
    """A dictionary name → float; its column is (N, T, names) float64."""


@dataclass(frozen=True)
class InfoKey:
    """One key of an info.

    Attributes:
        key: The key.
        kind: What it holds.
        names: Names that the last axis of its column runs over; empty unless `kind` has names.
    """

    key: str
    kind: InfoKind
    names: tuple[str, ...] = ()

    @property
    def dtype(self) -> np.dtype[Any]:
        """The dtype of its column, bool or float64."""
        return np.dtype(bool if self.kind in (InfoKind.FLAG, InfoKind.FLAGS) else np.float64)

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of its value at one moment."""
        match self.kind:
            case InfoKind.VECTOR:
                return (3,)
            case InfoKind.FLAG:
                return ()
            case InfoKind.FLAGS | InfoKind.NUMBERS:
                return (len(self.names),)


@dataclass(frozen=True)
class InfoLayout:
    """The keys of an info, in their order.

    Attributes:
        keys: The keys.
    """

    keys: tuple[InfoKey, ...]

    @classmethod
    def of(
        cls, columns: Mapping[str, NDArray[Any]], *, names: Mapping[str, Iterable[str]]
    ) -> "InfoLayout":
        """Read the layout off columns.

        A key that has names holds a dictionary; any other key a bool or a tuple of 3 floats.

        Args:
            columns: For each key, in order, an array (N, T, ...) of bool or float64.
            names: For each key that holds a dictionary the names of its entries, in order.
        """
        keys = []
        for key, column in columns.items():
            flags = column.dtype == np.bool_
            if key in names:
                kind = InfoKind.FLAGS if flags else InfoKind.NUMBERS
            else:
                kind = InfoKind.FLAG if flags else InfoKind.VECTOR
            keys.append(InfoKey(key, kind, tuple(names.get(key, ()))))
        return cls(tuple(keys))

    def to_json(self) -> list[list[Any]]:
        """Return the layout as JSON can hold it."""
        return [[key.key, str(key.kind), list(key.names)] for key in self.keys]

    @classmethod
    def from_json(cls, stored: list[list[Any]]) -> "InfoLayout":
        """Return the layout that `to_json` stored."""
        return cls(tuple(InfoKey(key, InfoKind(kind), tuple(names)) for key, kind, names in stored))
