"""How far the inferred condition of success agrees with the expert's."""

from dataclasses import dataclass

from lqd_search.runs.summary import Confusion, Outcomes


@dataclass(frozen=True)
class Agreement:
    """How far the inferred condition agrees with the expert's, in per cent, for people to read.

    Attributes:
        precision: Share of what the inferred condition approves that the expert's approves too; a
            dash where it approves nothing.
        recall: Share of what the expert's condition approves that the inferred one approves too; a
            dash where it approves nothing.
    """

    precision: str
    recall: str

    @classmethod
    def of(cls, counts: Confusion | Outcomes) -> "Agreement":
        """Return the agreement on motions, or on distinct solutions, by who approved them."""
        both = counts["both"]
        return cls(
            precision=_share(both, both + counts["inferred_only"]),
            recall=_share(both, both + counts["expert_only"]),
        )


def _share(part: int, whole: int) -> str:
    return f"{part / whole:.1%}" if whole else "-"
