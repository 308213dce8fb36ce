"""What a run's summary says of its functionals, in sentences."""

from lqd_search.evaluation.descriptor_report import DescriptorReport
from lqd_search.runs.run_config import NO_MODEL
from lqd_search.runs.summary import Summary


def functional_notes(summary: Summary) -> tuple[str, ...]:
    """Return a sentence for each functional that was stopped, dropped, repaired or remarked on."""
    noted = {
        "Stopped": summary["stopped"],
        "Not used": summary["dropped"],
        "Repaired": summary["repaired"],
        "To know": summary["remarks"],
    }
    return tuple(
        f"{what}: {sentence}" for what, sentences in noted.items() for sentence in sentences
    )


def steering_notes(summary: Summary) -> tuple[str, ...]:
    """Return a sentence where the expert steered, and nothing was inferred."""
    if summary["llm"] != NO_MODEL:
        return ()
    return ("Steered by the expert; the inferred condition here is the expert's own.",)


def descriptor_notes(summary: Summary) -> tuple[str, ...]:
    """Return sentences about descriptors without a grid, that say the same or that say nothing.

    Of a method that fills no grids nothing is said.
    """
    waiting = summary["waiting_descriptors"]
    if not (summary["grids"] or waiting):
        return ()
    report = DescriptorReport(
        same=tuple(map(tuple, summary["same_descriptors"])),
        degenerate=tuple(summary["degenerate_descriptors"]),
        undefined=tuple(summary["undefined_descriptors"]),
    )
    names = ", ".join(waiting)
    without = (f"Without a grid, since too few motions defined them: {names}.",) if names else ()
    return (*without, *report.sentences())
