"""The solution that `lqd adapt` found, as a file."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lqd_envs import LQDError
from lqd_envs.atomic_file import write_atomically
from lqd_envs.instances import Instance
from lqd_search.runs.new_file import why_no_new_file


@dataclass(frozen=True, eq=False)
class KeptSolution:
    """A solution that solves an instance, and where it was found.

    Attributes:
        instance: The instance.
        solution: (9,) the solution.
        elite: Its row in the run's archive.
        method: Method of the run.
        run_seed: Its seed.
        selector: Name of the selector.
        tries: How many tries it took.
        solving: Rows of all that solve the instance, of those that were tried, in that order.
    """

    instance: Instance
    solution: NDArray[np.float64]
    elite: int
    method: str
    run_seed: int
    selector: str
    tries: int
    solving: tuple[int, ...]

    def to_json(self) -> str:
        """Return the text of the file."""
        plain: dict[str, Any] = {
            "task": self.instance.task,
            "instance": self.instance.to_dict(),
            "name": self.instance.name,
            # Python writes every bit of a float, so that it is the same motion when it is read.
            "solution": self.solution.tolist(),
            "elite": self.elite,
            "method": self.method,
            "seed": self.run_seed,
            "selector": self.selector,
            "tries": self.tries,
            "solving": list(self.solving),
        }
        return json.dumps(plain, indent=2) + "\n"

    def write(self, path: Path) -> None:
        """Write the file.

        Raises:
            LQDError: It cannot be written.
        """
        try:
            write_atomically(path, self.to_json().encode())
        except OSError as error:
            raise _cannot(path, f"that failed ({error.strerror or error})") from error


def check_solution_path(path: Path) -> None:
    """Check, before anything is tried, that a solution may be kept in this file.

    Raises:
        LQDError: There is something already, or its folder does not exist.
    """
    why = why_no_new_file(path)
    if why is not None:
        raise _cannot(path, f"it {why}")


def _cannot(path: Path, why: str) -> LQDError:
    return LQDError(
        f"Expected to keep the solution in {path}, but {why}; choose another file with --out."
    )
