"""`metrics.csv`: a row for each generation, to be watched while it grows."""

import csv
import io
from collections.abc import Iterable
from dataclasses import asdict, dataclass, fields
from pathlib import Path

from lqd_envs.atomic_file import write_atomically
from lqd_search.runs.metrics import Metrics
from lqd_search.runs.run_folder_error import cannot_write


@dataclass(frozen=True)
class MetricsFile:
    """The file of a run's figures over time.

    Attributes:
        path: The file.
    """

    path: Path

    def write(self, rows: Iterable[Metrics]) -> None:
        """Write the file anew, as a whole.

        Raises:
            RunFolderError: It cannot be written.
        """
        try:
            write_atomically(self.path, _csv(rows, header=True).encode())
        except OSError as error:
            raise cannot_write(self.path, error, folder=self.path.parent) from error

    def append(self, row: Metrics) -> None:
        """Add a row.

        Raises:
            RunFolderError: It cannot be written.
        """
        try:
            with self.path.open("a", newline="") as file:
                file.write(_csv([row], header=False))
        except OSError as error:
            raise cannot_write(self.path, error, folder=self.path.parent) from error


def _csv(rows: Iterable[Metrics], *, header: bool) -> str:
    text = io.StringIO(newline="")
    writer = csv.DictWriter(text, [column.name for column in fields(Metrics)])
    if header:
        writer.writeheader()
    writer.writerows(map(asdict, rows))
    return text.getvalue()
