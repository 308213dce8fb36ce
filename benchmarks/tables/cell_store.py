"""The cells of a benchmark on disk: figures that are kept, and runs that are under way."""

import fcntl
import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from benchmarks.tables.cell import Cell
from benchmarks.tables.cell_figures import CellError, CellFigures
from lqd_envs.atomic_file import write_atomically
from lqd_search.methods.by_name import METHODS


@dataclass(frozen=True)
class CellStore:
    """The folder of a benchmark.

    `cells/` has a small JSON file for each finished cell, which is all that the tables need;
    `runs/` has the run folders, which are big and not meant for a repository.

    Attributes:
        out: The folder.
        evaluations: Evaluations of each of its cells.
        batch_size: Solutions in a generation of each of its cells.
    """

    out: Path
    evaluations: int
    batch_size: int

    def prepare(self) -> None:
        """Make the folders, in which git does not see the runs."""
        self._cells.mkdir(parents=True, exist_ok=True)
        self._runs.mkdir(exist_ok=True)
        (self._runs / ".gitignore").write_text("*\n")

    def run_folder(self, cell: Cell) -> Path:
        """Return where the cell's run is, or will be."""
        return self._runs / cell.name

    def log(self, cell: Cell) -> Path:
        """Return where what the cell's run prints is written."""
        return self._runs / f"{cell.name}.log"

    def note_commit(self, cell: Cell, commit: str) -> None:
        """Write down at which commit the cell's run is begun, or gone on with."""
        with self._commits(cell).open("a") as file:
            file.write(f"{commit}\n")

    def forget_commits(self, cell: Cell) -> None:
        """Begin the list of commits anew: that of an earlier run of the cell, if there is one."""
        self._commits(cell).unlink(missing_ok=True)

    def commits(self, cell: Cell) -> list[str]:
        """Return at which commits the cell's run was begun and gone on with, each once."""
        path = self._commits(cell)
        return list(dict.fromkeys(path.read_text().splitlines())) if path.exists() else []

    def load(self, cells: Iterable[Cell]) -> dict[Cell, CellFigures]:
        """Return the figures of those cells that are finished, in their order.

        Raises:
            CellError: A file is damaged, another cell's, or of another budget, another
                generation or other switches; or two cells differ in the functionals that they
                should share.
        """
        found = {cell: self._read(cell) for cell in cells if self._path(cell).exists()}
        self._check_functionals(found.values())
        return found

    def keep(self, figures: CellFigures) -> Path:
        """Write the figures of a finished cell.

        Raises:
            CellError: They are of another budget, another generation or other switches; or they
                and those of a cell that is kept differ in the functionals that they should share.
        """
        path = self._path(figures.cell)
        self._check(figures, figures.cell, path)
        self._check_functionals([*self._alike(figures.cell), figures])
        write_atomically(path, figures.to_json().encode())
        return path

    @contextmanager
    def claim(self, cell: Cell) -> Iterator[int | None]:
        """Lay hold of a cell's run for the length of a `with` block.

        A process that inherits the number that is handed out holds it too, for as long as it
        lives: a run whose benchmark was killed is not begun a second time beside the first.

        Args:
            cell: The cell.

        Yields:
            The number of an open file; None: another process holds it.
        """
        lock = os.open(self._runs / f"{cell.name}.lock", os.O_RDWR | os.O_CREAT)
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            os.close(lock)
            yield None
            return
        try:
            yield lock
        finally:
            os.close(lock)

    @property
    def _cells(self) -> Path:
        return self.out / "cells"

    @property
    def _runs(self) -> Path:
        return self.out / "runs"

    def _commits(self, cell: Cell) -> Path:
        return self._runs / f"{cell.name}.commits"

    def _path(self, cell: Cell) -> Path:
        return self._cells / f"{cell.name}.json"

    def _read(self, cell: Cell) -> CellFigures:
        path = self._path(cell)
        figures = _figures(path)
        self._check(figures, cell, path)
        return figures

    def _check(self, figures: CellFigures, cell: Cell, path: Path) -> None:
        if figures.cell != cell:
            raise CellError(
                f"Expected the cell {cell.name} in {path}, but got {figures.cell.name}; delete "
                "the file, and the cell is run again."
            )
        if (figures.evaluations, figures.batch_size) != (self.evaluations, self.batch_size):
            raise CellError(
                f"Expected a cell of {self.evaluations} evaluations, {self.batch_size} a "
                f"generation, in {path}, but got one of {figures.evaluations}, "
                f"{figures.batch_size} a generation; name a folder of the same scale, or one "
                "that is new."
            )
        # A variant of `ours` is no method, and has none.
        known = METHODS.get(cell.method)
        switches = tuple(sorted(known.switches)) if known else ()
        if figures.switches != switches:
            raise CellError(
                f"Expected the switches {_listed(switches)} of {cell.method} in {path}, but it "
                f"was run with {_listed(figures.switches)}; delete it and its folder in runs/, "
                "and the cell is run again."
            )

    def _alike(self, cell: Cell) -> list[CellFigures]:
        """Return what is kept of other cells with the same task and recording."""
        alike = self._cells.glob(f"{cell.task}.*.sample-{cell.sample}.json")
        return [_figures(path) for path in sorted(alike) if path != self._path(cell)]

    def _check_functionals(self, found: Iterable[CellFigures]) -> None:
        first: dict[tuple[str, int, str], CellFigures] = {}
        for figures in found:
            one = first.setdefault((figures.task, figures.sample, figures.steering), figures)
            if one.functionals != figures.functionals:
                raise CellError(
                    f"Expected the same functionals in the cells {one.cell.name} and "
                    f"{figures.cell.name}, but their digests are {one.functionals} and "
                    f"{figures.functionals}; of those that are out of date, delete the files in "
                    f"{self._cells} and the folders in {self._runs}, and they are run again."
                )


def _figures(path: Path) -> CellFigures:
    try:
        return CellFigures.from_json(path.read_text())
    except CellError as error:
        raise CellError(f"{path}: {error}") from error


def _listed(switches: tuple[str, ...]) -> str:
    return "+".join(switches) or "none"
