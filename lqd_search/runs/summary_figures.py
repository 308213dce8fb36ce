"""The figures of a run's summary, as tables show them."""

from dataclasses import dataclass

from lqd_search.runs.summary import Summary


@dataclass(frozen=True)
class SummaryFigure:
    """One figure.

    Attributes:
        name: What it is called.
        value: How many there are.
        under: Name of the figure that it is a part of, or says more of; empty: none.
    """

    name: str
    value: int
    under: str = ""


def figures_of(summary: Summary) -> tuple[SummaryFigure, ...]:
    """Return the figures of a run's `summary.json`, in the order in which they are read."""
    outcomes = summary["outcomes"]
    met = "distinct successes of the whole run (expert)"
    figures = [
        SummaryFigure("evaluations", summary["evaluations"]),
        *_with_causes("rejected", summary["rejected"]),
        *_with_causes("discarded", summary["discarded"]),
        SummaryFigure("valid", summary["valid"]),
        SummaryFigure("distinct elites", summary["archive_size"]),
        SummaryFigure("inferred successes", summary["inferred_archive_size"], "distinct elites"),
        SummaryFigure("success archive size (expert)", summary["success_archive_size"]),
        SummaryFigure("ground-truth cells", summary["ground_truth_cells"]),
        SummaryFigure(
            "successes outside that grid", summary["ground_truth_outside"], "ground-truth cells"
        ),
        SummaryFigure(met, outcomes["both"] + outcomes["expert_only"]),
        SummaryFigure("ground-truth cells", outcomes["ground_truth_cells"], met),
        SummaryFigure("refused values", sum(row["count"] for row in summary["refused"])),
    ]
    if summary["grids"]:
        outside = sum(grid["clipped"] for grid in summary["grids"])
        figures.append(SummaryFigure("solutions out of range, over all grids", outside))
    return tuple(figures)


def _with_causes(name: str, counts: dict[str, int]) -> list[SummaryFigure]:
    causes = [SummaryFigure(cause, count, name) for cause, count in counts.items()]
    return [SummaryFigure(name, sum(counts.values())), *causes]
