"""The tables of a report: what each run was asked to do, and what it came to."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from lqd_search.report.reported_run import ReportedRun
from lqd_search.runs.agreement import Agreement
from lqd_search.runs.summary import Confusion, Outcomes
from lqd_search.runs.summary_figures import SummaryFigure, figures_of
from lqd_search.runs.summary_notes import descriptor_notes, functional_notes, steering_notes


@dataclass(frozen=True)
class TableRow:
    """One line of a table with a column for each run.

    Attributes:
        name: What stands at its start.
        cells: A text for each run; empty where it has none.
    """

    name: str
    cells: tuple[str, ...]

    @property
    def shared(self) -> bool:
        """Whether several runs have one text, which is then enough for all of them."""
        return len(self.cells) > 1 and len(set(self.cells)) == 1


def settings_rows(runs: Sequence[ReportedRun]) -> tuple[TableRow, ...]:
    """Return what each run was asked to do, and with what."""
    rows = _merged(_settings(run) for run in runs)
    return tuple(row for row in rows if any(row.cells))


def figure_rows(runs: Sequence[ReportedRun]) -> tuple[TableRow, ...]:
    """Return what each run came to: the figures of `lqd show`."""
    return _merged(_figures(run) for run in runs)


def notes(run: ReportedRun) -> tuple[str, ...]:
    """Return sentences about what steered a run: what was stopped, refused or found alike."""
    summary = run.summary
    return (
        *functional_notes(summary),
        *(
            f"Refused values of {row['kind']} {row['functional']}: {row['count']:,} "
            f"({row['reason']})."
            for row in summary["refused"]
        ),
        *descriptor_notes(summary),
        *steering_notes(summary),
    )


def _merged(columns: Iterable[dict[str, str]]) -> tuple[TableRow, ...]:
    tables = list(columns)
    names: list[str] = []
    for table in tables:
        for before, name in zip([None, *table], table, strict=False):
            if name not in names:
                # A line that the runs before lack stands where this run has it.
                names.insert(names.index(before) + 1 if before else 0, name)
    return tuple(TableRow(name, tuple(t.get(name, "") for t in tables)) for name in names)


def _settings(run: ReportedRun) -> dict[str, str]:
    config = run.config
    return {
        "task": config.task,
        "instruction": config.instruction,
        "method": config.method,
        "seed": str(config.seed),
        "evaluations": f"{config.evaluations:,}",
        "batch size": f"{config.batch_size:,}",
        "failures compete by": config.failure_competition,
        "functionals": "the expert's" if config.steered_by_expert else config.llm,
        "sample": str(config.sample),
        "model": config.model,
        "provenance": config.provenance,
        "usage": config.usage_in_words,
        "versions": ", ".join(f"{name} {version}" for name, version in config.versions.items()),
    }


def _figures(run: ReportedRun) -> dict[str, str]:
    summary = run.summary
    return {
        **{_called(figure): f"{figure.value:,}" for figure in figures_of(summary)},
        **_agreement(summary["confusion"], of="valid motions"),
        **_agreement(summary["outcomes"], of="distinct solutions"),
        **_exploration(run),
        "seconds": f"{summary['seconds']:,.0f}",
    }


def _called(figure: SummaryFigure) -> str:
    return f"{figure.under}: {figure.name}" if figure.under else figure.name


def _agreement(counts: Confusion | Outcomes, *, of: str) -> dict[str, str]:
    agreement = Agreement.of(counts)
    return {
        f"inferred condition's precision, {of}": agreement.precision,
        f"inferred condition's recall, {of}": agreement.recall,
    }


def _exploration(run: ReportedRun) -> dict[str, str]:
    chosen = run.summary["chosen_fitness"]
    return {
        f"found when exploring {name}": f"{found:,}{' (kept)' if name == chosen else ''}"
        for name, found in run.summary["exploration"].items()
    }
