"""One run of a benchmark: a method on a task with a seed and a recording."""

from dataclasses import dataclass

RECORDINGS = 5
"""How many recorded samples of the model's replies there are for each task."""


@dataclass(frozen=True, order=True)
class Cell:
    """One run of a benchmark.

    Attributes:
        task: Short name of the task.
        method: Name of the method, or of a variant of `ours`.
        seed: Seed of the search.
        sample: Which recorded sample of the model's replies steers it.
    """

    task: str
    method: str
    seed: int
    sample: int

    @classmethod
    def of(cls, task: str, method: str, seed: int) -> "Cell":
        """Return the cell of a seed, which goes with the recording `seed` modulo 5."""
        return cls(task, method, seed, seed % RECORDINGS)

    @property
    def name(self) -> str:
        """What its files are called."""
        return f"{self.task}.{self.method}.seed-{self.seed}.sample-{self.sample}"

    @property
    def task_id(self) -> str:
        """Id of the task."""
        return f"LQD/{self.task.capitalize()}-v0"
