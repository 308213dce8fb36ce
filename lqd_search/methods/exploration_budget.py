"""How the evaluations of a fitness exploration are shared."""

from dataclasses import dataclass

from lqd_envs.errors import LQDError


class BudgetError(LQDError):
    """The evaluations do not suffice for the fitness exploration."""


@dataclass(frozen=True)
class ExplorationBudget:
    """How the evaluations are shared between the short runs and the long one.

    Each short run gets a tenth of the evaluations, rounded down to whole generations. The first
    generation of all of them is the same one, evaluated and counted once.

    Attributes:
        evaluations: All there are.
        batch_size: Number of solutions in a generation; the last one may be smaller.
        runs: Number of short runs.

    Raises:
        BudgetError: There is no run, a short run would have fewer than two generations, or nothing
            would be left after the short runs.
    """

    evaluations: int
    batch_size: int
    runs: int

    def __post_init__(self) -> None:
        if self.runs < 1 or self.batch_size < 1:
            raise BudgetError(
                "Expected at least one fitness and a batch size of at least 1, but got "
                f"{self.runs} and {self.batch_size}; raise what is too low."
            )
        if self.short_generations < 2:
            remedy = (
                f"use a batch size of at most {self.evaluations // 20}"
                if self.evaluations >= 20
                else "spend at least 20 evaluations"
            )
            raise BudgetError(
                "Expected a tenth of the evaluations to make at least two generations, but a tenth "
                f"of {self.evaluations} makes {self.short_generations} of {self.batch_size}; "
                f"{remedy}."
            )
        if self.exploration >= self.evaluations:
            raise BudgetError(
                f"Expected evaluations to be left after a tenth of {self.evaluations} for each of "
                f"{self.runs} fitness functions, but there are none; use at most 10 of these."
            )

    @property
    def short_generations(self) -> int:
        """Generations of each short run (b1), the first one included."""
        return self.evaluations // (10 * self.batch_size)

    @property
    def exploration(self) -> int:
        """Evaluations that the first generation and all short runs take."""
        return self.batch_size * (1 + self.runs * (self.short_generations - 1))

    def run_at(self, evaluations: int) -> int | None:
        """Return which short run it is the turn of.

        Args:
            evaluations: Number of evaluations spent, the first generation's among them.

        Returns:
            Its index; None after the exploration.
        """
        if evaluations >= self.exploration:
            return None
        return (evaluations // self.batch_size - 1) // (self.short_generations - 1)
