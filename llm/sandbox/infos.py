"""The infos of one motion, built from the columns. This file runs in the worker."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import Any

from numpy.typing import NDArray

from lqd_llm.sandbox.info_layout import InfoKey, InfoKind, InfoLayout

Infos = list[Mapping[str, Any]]
"""The moments of a motion, in order; read-only, since all functions of a motion share them."""

_NOTHING: Mapping[str, Any] = MappingProxyType({})


class InfosBuilder:
    """Builds the infos of motions.

    Args:
        layout: The keys.
    """

    def __init__(self, layout: InfoLayout) -> None:
        self._layout = layout
        self._assemble = _assembler(len(layout.keys))
        self._keys = [key.key for key in layout.keys]

    def __call__(self, columns: Sequence[NDArray[Any]], motion: int) -> Infos:
        """Return the infos of one motion.

        Args:
            columns: For each key of the layout its column, (N, T, ...).
            motion: Index of the motion.
        """
        pairs = zip(self._layout.keys, columns, strict=True)
        values = [_values(key, column[motion]) for key, column in pairs]
        return self._assemble(self._keys, values)


def _assembler(keys: int) -> Callable[[Sequence[str], Sequence[Iterable[Any]]], Infos]:
    """Return a function that makes a read-only mapping of each row of values.

    It is written out for the number of keys, since a dictionary display takes half as long as
    `dict(zip(...))`, and a tenth of all time goes into this.
    """
    names = [f"k{i}, v{i}".split(", ") for i in range(keys)]
    entries = ", ".join(f"{key}: {value}" for key, value in names)
    code = (
        f"def assemble(keys, values):\n"
        f"    [{', '.join(key for key, _ in names)}] = keys\n"
        f"    return [view({{{entries}}}) for {', '.join(v for _, v in names)}, in zip(*values)]\n"
    )
    namespace: dict[str, Any] = {"view": MappingProxyType}
    exec(code, namespace)  # noqa: S102
    assemble: Callable[[Sequence[str], Sequence[Iterable[Any]]], Infos] = namespace["assemble"]
    return assemble


def _values(key: InfoKey, column: NDArray[Any]) -> Iterable[Any]:
    rows: list[Any] = column.tolist()
    match key.kind:
        case InfoKind.VECTOR:
            return map(tuple, rows)
        case InfoKind.FLAG:
            return rows
        case InfoKind.FLAGS | InfoKind.NUMBERS:
            names = key.names
            if not names:
                return [_NOTHING] * len(rows)
            # strict=True would cost time; the columns have as many entries as there are names.
            return [MappingProxyType(dict(zip(names, row, strict=False))) for row in rows]
