"""The archive of a run as one open file, `archive.npz`."""

import io
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np
from numpy.typing import NDArray

from lqd_envs import LQDError
from lqd_search.grid_spec import GridSpec
from lqd_search.multi_bd_archive import MultiBDArchive


class StoredArchiveError(LQDError):
    """An archive file that is missing, damaged or of another form."""


@dataclass(frozen=True, eq=False)
class StoredGrid:
    """One descriptor's grid.

    Attributes:
        spec: Its cells and ranges.
        cells: (k,) flat (C order) indices of the filled cells.
        elites: (k,) rows of the archive's distinct elites that hold them.
        measures: (k, d) float64 measures of these elites.
    """

    spec: GridSpec
    cells: NDArray[np.int64]
    elites: NDArray[np.int64]
    measures: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class StoredArchive:
    """The distinct elites of a run, and the grids that they hold cells of.

    Attributes:
        fields: A column of m rows for each field: `solution`, `objective`, `success` (the inferred
            condition), `evaluation`, and the passive ones.
        grids: The grids by descriptor.
    """

    fields: Mapping[str, NDArray[Any]]
    grids: Mapping[str, StoredGrid]

    def __len__(self) -> int:
        """Return the number of distinct elites."""
        return len(self.fields["solution"])

    @classmethod
    def of(cls, archive: MultiBDArchive) -> "StoredArchive":
        """Return what of an archive is stored."""
        elites = archive.elites()
        return cls(
            fields=elites.fields,
            grids={
                name: StoredGrid(
                    spec=spec,
                    cells=elites.cells[name].astype(np.int64),
                    elites=elites.rows[name].astype(np.int64),
                    measures=archive.grid_elites(name)["measures"],
                )
                for name, spec in archive.specs.items()
            },
        )

    def to_bytes(self) -> bytes:
        """Return the contents of `archive.npz`; equal archives give equal bytes."""
        columns: dict[str, NDArray[Any]] = {
            f"elites/{name}": column for name, column in self.fields.items()
        }
        for name, grid in self.grids.items():
            columns[f"grids/{name}/dims"] = np.asarray(grid.spec.dims, dtype=np.int64)
            columns[f"grids/{name}/ranges"] = np.asarray(grid.spec.ranges, dtype=np.float64)
            columns[f"grids/{name}/cells"] = grid.cells
            columns[f"grids/{name}/elites"] = grid.elites
            columns[f"grids/{name}/measures"] = grid.measures
        buffer = io.BytesIO()
        np.savez_compressed(buffer, allow_pickle=False, **columns)
        return buffer.getvalue()

    @classmethod
    def load(cls, path: Path) -> "StoredArchive":
        """Read an `archive.npz`.

        Raises:
            StoredArchiveError: It is missing, damaged or of another form.
        """
        try:
            with np.load(io.BytesIO(path.read_bytes()), allow_pickle=False) as file:
                columns = {name: file[name] for name in file.files}
            return cls(fields=_elite_fields(columns), grids=_grids(columns))
        except (OSError, EOFError, ValueError, KeyError, BadZipFile) as error:
            raise StoredArchiveError(
                f"Expected an archive in {path}, but it cannot be read ({error}); run the search "
                "again."
            ) from error


def _elite_fields(columns: Mapping[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
    fields = {
        name.removeprefix("elites/"): column
        for name, column in columns.items()
        if name.startswith("elites/")
    }
    fields["solution"]
    return fields


def _grids(columns: Mapping[str, NDArray[Any]]) -> dict[str, StoredGrid]:
    names = [
        name.removeprefix("grids/").removesuffix("/dims")
        for name in columns
        if name.startswith("grids/") and name.endswith("/dims")
    ]
    return {
        name: StoredGrid(
            spec=GridSpec(
                dims=tuple(int(n) for n in columns[f"grids/{name}/dims"]),
                ranges=tuple(
                    (float(low), float(high)) for low, high in columns[f"grids/{name}/ranges"]
                ),
            ),
            cells=columns[f"grids/{name}/cells"],
            elites=columns[f"grids/{name}/elites"],
            measures=columns[f"grids/{name}/measures"],
        )
        for name in names
    }
