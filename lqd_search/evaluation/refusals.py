"""Values of functionals that were refused, noted while a batch is judged."""

from dataclasses import dataclass, field

from lqd_search.evaluation.functional_calls import RefusedValueError
from lqd_search.evaluation.values import Refusal


@dataclass
class Refusals:
    """What was refused so far, by kind, functional and reason, in the order it was first met.

    Attributes:
        motions: For each of these the motions, in the order in which they came.
    """

    motions: dict[tuple[str, str, str], dict[int, None]] = field(default_factory=dict)

    def note(self, motion: int, kind: str, functional: str, refused: RefusedValueError) -> None:
        """Note that a motion's value was refused; a second time for the same reason counts once."""
        self.motions.setdefault((kind, functional, str(refused)), {})[motion] = None

    def listed(self) -> tuple[Refusal, ...]:
        """Return them for the values of the batch."""
        return tuple(
            Refusal(functional, kind, len(motions), reason, min(motions))
            for (kind, functional, reason), motions in self.motions.items()
        )
