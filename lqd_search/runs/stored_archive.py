"""The archive of a run as one open file, `archive.npz`."""

import io
from collections.abc import Mapping
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lqd_envs import LQDError
from lqd_search.archives.grid_spec import GridSpec, GridSpecError
from lqd_search.evaluation.motion_evaluator import DIGEST, EXPERT, GROUND_TRUTH
from lqd_search.methods.method import Method
from lqd_search.runs.npz_columns import ColumnError, column_of, read_columns

_ELITES: Mapping[str, tuple[type[np.generic], int]] = {
    "solution": (np.float64, 2),
    "objective": (np.float64, 1),
    "success": (np.bool_, 1),
    "evaluation": (np.int64, 1),
}
PASSIVE: Mapping[str, tuple[type[np.generic], int]] = {
    EXPERT: (np.bool_, 1),
    GROUND_TRUTH: (np.float64, 2),
    DIGEST: (np.uint64, 1),
}
"""The columns of the elites beside those that every method has, in a run of `lqd run`."""
_SPEC: Mapping[str, type[np.generic]] = {"dims": np.int64, "ranges": np.float64}


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
    """What a run puts out: distinct solutions, and the grids that they hold cells of.

    Attributes:
        fields: A column of m rows for each field: `solution`, `objective`, `success` (the inferred
            condition), `evaluation`, and the passive ones, which in a run of `lqd run` are
            `expert`, `ground_truth` and `digest`.
        grids: The grids by descriptor.
    """

    fields: Mapping[str, NDArray[Any]]
    grids: Mapping[str, StoredGrid]

    def __len__(self) -> int:
        """Return the number of distinct elites."""
        return len(self.fields["solution"])

    @classmethod
    def of(cls, method: Method) -> "StoredArchive":
        """Return what of a method's output is stored; without an archive it has no grids.

        Args:
            method: Any method, with passive columns or without.
        """
        archive = method.archive
        if archive is None:
            return cls(fields=method.output(), grids={})
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
            for key, numbers in grid.spec.to_dict().items():
                columns[f"grids/{name}/{key}"] = np.asarray(numbers, dtype=_SPEC[key])
            columns[f"grids/{name}/cells"] = grid.cells
            columns[f"grids/{name}/elites"] = grid.elites
            columns[f"grids/{name}/measures"] = grid.measures
        buffer = io.BytesIO()
        np.savez_compressed(buffer, allow_pickle=False, **columns)
        return buffer.getvalue()

    @classmethod
    def load(cls, path: str | PathLike[str]) -> "StoredArchive":
        """Read an `archive.npz`.

        Raises:
            StoredArchiveError: It is missing, damaged or of another form.
        """
        try:
            columns = read_columns(Path(path))
            fields = _elite_fields(columns)
            return cls(fields=fields, grids=_grids(columns, elites=len(fields["solution"])))
        except ColumnError as error:
            raise StoredArchiveError(
                f"Expected an archive in {path}, but it cannot be read ({error}); run the search "
                "again."
            ) from error


def _elite_fields(columns: Mapping[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
    passive = {name: form for name, form in PASSIVE.items() if f"elites/{name}" in columns}
    for name, (dtype, ndim) in {**_ELITES, **passive}.items():
        column_of(columns, f"elites/{name}", dtype=dtype, ndim=ndim)
    fields = {
        name.removeprefix("elites/"): column
        for name, column in columns.items()
        if name.startswith("elites/")
    }
    for name, column in fields.items():
        if column.shape[:1] != fields["solution"].shape[:1]:
            raise ColumnError(
                f"expected as many rows in elites/{name} as in elites/solution, got "
                f"{column.shape} and {fields['solution'].shape}"
            )
    return fields


def _grids(columns: Mapping[str, NDArray[Any]], *, elites: int) -> dict[str, StoredGrid]:
    names = [
        name.removeprefix("grids/").removesuffix("/dims")
        for name in columns
        if name.startswith("grids/") and name.endswith("/dims")
    ]
    return {name: _grid(columns, f"grids/{name}", elites=elites) for name in names}


def _grid(columns: Mapping[str, NDArray[Any]], place: str, *, elites: int) -> StoredGrid:
    spec = {
        key: column_of(columns, f"{place}/{key}", dtype=dtype, ndim=1 if key == "dims" else 2)
        for key, dtype in _SPEC.items()
    }
    if spec["ranges"].shape != (len(spec["dims"]), 2):
        raise ColumnError(f"expected two bounds for each dimension in {place}/ranges")
    try:
        grid = StoredGrid(
            spec=GridSpec.from_dict(spec),
            cells=column_of(columns, f"{place}/cells", dtype=np.int64, ndim=1),
            elites=column_of(columns, f"{place}/elites", dtype=np.int64, ndim=1),
            measures=column_of(columns, f"{place}/measures", dtype=np.float64, ndim=2),
        )
    except GridSpecError as error:
        raise ColumnError(f"{place}: {str(error).rstrip('.')}") from error
    if grid.measures.shape != (len(grid.cells), len(spec["dims"])):
        raise ColumnError(f"expected a row of measures for each cell in {place}/measures")
    _check_indices(f"{place}/cells", grid.cells, below=grid.spec.cells)
    _check_indices(f"{place}/elites", grid.elites, below=elites)
    if len(grid.elites) != len(grid.cells):
        raise ColumnError(f"expected as many rows in {place}/elites as in {place}/cells")
    return grid


def _check_indices(name: str, indices: NDArray[np.int64], *, below: int) -> None:
    if ((indices < 0) | (indices >= below)).any():
        raise ColumnError(f"expected numbers from 0 to {below - 1} in {name}, got others")
