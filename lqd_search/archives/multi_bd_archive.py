"""The multi-BD archive: one grid per descriptor, all offered the same solutions."""

import copy
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from ribs.archives import ArchiveBase, ArchiveStats, GridArchive
from ribs.typing import BatchData, FieldDesc, Int, SingleData

from lqd_search.archives.archive_fields import ArchiveError, ArchiveFields
from lqd_search.archives.cell_rows import pack, row_dtype
from lqd_search.archives.competition import Competition, compete_by_fitness
from lqd_search.archives.elites import Elites, unite
from lqd_search.archives.grid_spec import GridSpec
from lqd_search.archives.success_grid import Insertion, SuccessGrid


class MultiBDArchive(ArchiveBase):
    """One grid per descriptor, all offered the same solutions, in which success comes first.

    Its measures are those of all descriptors side by side; a row that is NaN in one descriptor's
    columns is undefined there and is not offered to that grid. A descriptor has no grid before
    `set_grid`, since its range may not be known yet.

    It is the archive that the paper's MAP-Elites Success fills for a mesh of descriptors.

    pyribs' schedulers run on it, and its emitters: those that sample elites, and CMA-ME with the
    rankers `imp`, `2imp`, `obj` and `2obj` where all measures are defined, but not with `rd` and
    `2rd`, which need the bounds of one measure space. Give every descriptor its grid first, and
    pass `success=` and the extra fields to their `tell`. Of pyribs' archive interface, `data`,
    `retrieve`, `retrieve_single` and iteration are not implemented, since an elite has other
    measures in each grid: see `elites`, `grid_elites` and `grids`.

    Args:
        descriptors: For each descriptor, in order, its number of measures.
        solution_dim: Length of a solution.
        extra_fields: Fields to store beside solution, objective, measures and success, in pyribs'
            form: name to (shape, dtype).
        competition: The rule by which a cell is won. Each `add` works on a copy and keeps it once
            all is done, so that an error leaves a rule that tosses coins as it was.
        seed: Seed or generator of `sample_elites`.

    Attributes:
        fields: The fields of an elite, which check a batch.

    Raises:
        ArchiveError: There is no descriptor, one has no measures, or an extra field has a name
            that is taken or not an identifier.
    """

    def __init__(
        self,
        *,
        descriptors: Mapping[str, int],
        solution_dim: int,
        extra_fields: FieldDesc | None = None,
        competition: Competition = compete_by_fitness,
        seed: int | np.random.Generator | None = None,
    ) -> None:
        self.fields = ArchiveFields(dict(descriptors), solution_dim, extra_fields or {})
        super().__init__(
            solution_dim=solution_dim, objective_dim=(), measure_dim=sum(descriptors.values())
        )
        self._competition = competition
        self._row_dtype = row_dtype(solution_dim=solution_dim, fields=self.fields.beside_measures)
        self._rng = np.random.default_rng(seed)
        self._grids: dict[str, SuccessGrid] = {}
        # The cells of the grids' elites that it was made of: they are other arrays after a change.
        self._union: tuple[Mapping[str, NDArray[np.integer]], Elites] | None = None

    @property
    def descriptors(self) -> Mapping[str, int]:
        """For each descriptor, in order, its number of measures."""
        return self.fields.descriptors

    @property
    def grids(self) -> Mapping[str, GridArchive]:
        """The pyribs grids of the descriptors that have one, in order; to be read only."""
        return {name: grid.archive for name, grid in self._grids.items()}

    @property
    def specs(self) -> Mapping[str, GridSpec]:
        """The shapes of these grids."""
        return {name: grid.spec for name, grid in self._grids.items()}

    @property
    def clipped(self) -> Mapping[str, int]:
        """For each grid, how many solutions it was offered so far with a measure out of range."""
        return {name: grid.clipped for name, grid in self._grids.items()}

    @property
    def filled(self) -> Mapping[str, int]:
        """For each grid, how many of its cells have an elite."""
        return {name: len(grid) for name, grid in self._grids.items()}

    @property
    def successes(self) -> Mapping[str, int]:
        """For each grid, how many of its elites are successes."""
        return {name: grid.successes for name, grid in self._grids.items()}

    @property
    def field_list(self) -> list[str]:
        """Names of an elite's fields."""
        return list(self.dtypes)

    @property
    def dtypes(self) -> dict[str, Any]:
        """For each field its dtype."""
        return self.fields.dtypes

    @property
    def empty(self) -> bool:
        """Whether no grid has an elite."""
        return not any(self.filled.values())

    @property
    def stats(self) -> ArchiveStats:
        """Statistics over the distinct elites; the coverage is that of all cells of all grids."""
        elites = self.elites()
        objective = elites.fields["objective"]
        cells = max(1, sum(spec.cells for spec in self.specs.values()))
        filled = sum(self.filled.values())
        return ArchiveStats(
            num_elites=len(elites),
            coverage=filled / cells,
            qd_score=objective.sum(),
            norm_qd_score=objective.sum() / cells,
            obj_max=objective.max() if len(elites) else None,
            obj_mean=objective.mean() if len(elites) else None,
        )

    def __len__(self) -> int:
        """Number of distinct solutions over all grids; it unites them first."""
        return len(self.elites())

    def emptied(self) -> "MultiBDArchive":
        """Return a new archive for the same fields and by the same rule, without any grid."""
        return MultiBDArchive(
            descriptors=self.descriptors,
            solution_dim=self.fields.solution_dim,
            extra_fields=self.fields.extra,
            competition=self._competition,
            seed=self._rng,
        )

    def set_grid(self, name: str, spec: GridSpec) -> None:
        """Give a descriptor an empty grid, in place of the one that it may have.

        Args:
            name: The descriptor.
            spec: Cells and ranges, with as many dimensions as the descriptor has measures.

        Raises:
            ArchiveError: The descriptor is unknown, or the numbers of dimensions differ.
        """
        if len(spec.dims) != self.descriptors[self._known(name)]:
            raise ArchiveError(
                f"Expected a grid of {self.descriptors[name]} dimensions for descriptor {name!r}, "
                f"but got one of {len(spec.dims)}; give it a range for each measure."
            )
        grids = self._grids | {
            name: SuccessGrid(
                spec,
                solution_dim=self.fields.solution_dim,
                fields=self.fields.beside_measures,
            )
        }
        self._grids = {key: grids[key] for key in self.descriptors if key in grids}

    def drop_grid(self, name: str) -> None:
        """Take a descriptor's grid away, with all its elites, if it has one.

        Args:
            name: The descriptor.

        Raises:
            ArchiveError: The descriptor is unknown.
        """
        self._grids.pop(self._known(name), None)

    def clear(self) -> None:
        """Empty every grid, and keep their shapes."""
        for name, spec in self.specs.items():
            self.set_grid(name, spec)

    def add(
        self, solution: ArrayLike, objective: ArrayLike, measures: ArrayLike, **fields: ArrayLike
    ) -> BatchData:
        """Offer a batch to every grid.

        All of it is checked before any grid is touched, and if one fails or is interrupted all the
        same, every grid is brought back: after an error the archive is what it was before.

        Args:
            solution: (N, solution_dim) finite.
            objective: (N,) finite.
            measures: (N, sum of the descriptors' lengths), NaN rows in a descriptor's columns
                where it is undefined.
            **fields: `success`, (N,) bool, and each extra field with N rows.

        Returns:
            `status` (N,) int32: 2 where the solution holds a cell that was empty before the batch,
            else 1 where it took one over, else 0. `value` (N,) float64: the largest over the grids
            of its objective less that of the elite before it, if any; -inf where no grid was
            offered the solution.

        Raises:
            ArchiveError: A field is missing or unknown, has another shape or a dtype that does
                not fit, or a solution or objective is not finite.
            ValuesError: A descriptor's measures are infinite, or NaN only in part of a row.
        """
        batch = self.fields.check(
            {"solution": solution, "objective": objective, "measures": measures, **fields}
        )
        side_by_side = np.asfortranarray(batch.pop("measures"))
        rows = pack(batch, dtype=self._row_dtype)
        before, competition = self._competition, copy.deepcopy(self._competition)
        plans = [
            grid.plan(rows, side_by_side[:, self.fields.columns_of(name)], competition=competition)
            for name, grid in self._grids.items()
        ]
        outcome = _outcome(len(rows), plans)
        touched: list[tuple[SuccessGrid, Insertion]] = []
        complete = False
        try:
            self._competition = competition
            for grid, plan in zip(self._grids.values(), plans, strict=True):
                touched.append((grid, plan))
                grid.insert(plan)
            complete = True
        finally:
            if not complete:
                self._competition = before
                for grid, plan in touched:
                    grid.undo(plan)
        return outcome

    def add_single(
        self, solution: ArrayLike, objective: ArrayLike, measures: ArrayLike, **fields: ArrayLike
    ) -> SingleData:
        """Offer one solution to every grid.

        Args:
            solution: (solution_dim,) finite.
            objective: A finite number.
            measures: (sum of the descriptors' lengths,), NaN where undefined.
            **fields: `success`, a bool, and each extra field.

        Returns:
            `status` and `value` as from `add`, of this one solution.

        Raises:
            ArchiveError: As from `add`.
            ValuesError: As from `add`.
        """
        one = {name: np.asarray(value)[None] for name, value in fields.items()}
        info = self.add(
            np.asarray(solution)[None],
            np.asarray(objective)[None],
            np.asarray(measures)[None],
            **one,
        )
        return {name: column[0] for name, column in info.items()}

    def sample_elites(self, n: Int, replace: bool = True) -> BatchData:
        """Draw distinct elites uniformly, whichever and however many cells they hold.

        Args:
            n: How many.
            replace: Whether one may be drawn twice.

        Returns:
            For each field but the measures n rows.

        Raises:
            ArchiveError: The archive is empty, or has fewer than n where none may be drawn twice.
        """
        elites = self.elites()
        if len(elites) == 0 or (not replace and len(elites) < n):
            raise ArchiveError(
                f"Expected to draw {n} elites {'with' if replace else 'without'} replacement, but "
                f"the archive has {len(elites)}; add solutions first or ask for fewer."
            )
        rows = self._rng.choice(len(elites), size=n, replace=replace)
        return {name: column[rows] for name, column in elites.fields.items()}

    def grid_elites(self, name: str) -> BatchData:
        """Return one grid's elites in the order of their cells.

        Args:
            name: The descriptor.

        Returns:
            (m, ...) rows of every field, with the cell as `index`.

        Raises:
            ArchiveError: The descriptor is unknown or has no grid yet.
        """
        if self._known(name) not in self._grids:
            raise ArchiveError(
                f"Descriptor {name!r} has no grid yet; those with one: "
                f"{', '.join(self._grids) or 'none'}."
            )
        return self._grids[name].elites()

    def elites(self) -> Elites:
        """Return the union of the grids' elites without duplicates.

        Returns:
            The union, ordered by `evaluation` where there is this extra field, and otherwise by
            first appearance, grid by grid and cell by cell.
        """
        grids = {name: grid.elites() for name, grid in self._grids.items()}
        cells = {name: grid["index"] for name, grid in grids.items()}
        if self._union is None or not _same(cells, self._union[0]):
            self._union = (cells, unite(grids, empty=self.fields.empty_union()))
        union = self._union[1]
        # The arrays are read-only, and with dicts of its own no caller can spoil the next one's.
        return Elites(fields=dict(union.fields), rows=dict(union.rows), cells=dict(union.cells))

    def __getstate__(self) -> dict[str, Any]:
        """Return what a copy needs, which is not what can be computed again."""
        return self.__dict__ | {"_union": None}

    def _known(self, name: str) -> str:
        if name not in self.descriptors:
            raise ArchiveError(
                f"Unknown descriptor {name!r}; the archive has {', '.join(self.descriptors)}."
            )
        return name


def _same(ours: Mapping[str, NDArray[Any]], theirs: Mapping[str, NDArray[Any]]) -> bool:
    return list(ours) == list(theirs) and all(ours[name] is theirs[name] for name in ours)


def _outcome(n: int, insertions: Sequence[Insertion]) -> BatchData:
    status = np.zeros(n, np.int32)
    value = np.full(n, -np.inf)
    for plan in insertions:
        news = np.where(plan.occupied, 1, 2)
        status[plan.winners] = np.maximum(status[plan.winners], news)
        value[plan.offered] = np.maximum(value[plan.offered], plan.value)
    return {"status": status, "value": value}
