"""A run's figures as a table."""

import math

from rich import box
from rich.console import Console
from rich.table import Table

from lqd_search.evaluation.descriptor_report import DescriptorReport
from lqd_search.runs.summary import Summary


def print_summary(summary: Summary) -> None:
    """Print the contents of a run's `summary.json` on standard output."""
    console = Console()
    console.print(_figures(summary))
    console.print(_verdicts(summary))
    if summary["grids"]:
        console.print(_grids(summary))
    if summary["refused"]:
        console.print(_refusals(summary))
    for title, sentences in (
        ("Stopped", summary["stopped"]),
        ("Not used", summary["dropped"]),
        ("Repaired", summary["repaired"]),
        ("To know", summary["remarks"]),
    ):
        for sentence in sentences:
            console.print(f"{title}: {sentence}", markup=False, highlight=False)
    if summary["waiting_descriptors"]:
        names = ", ".join(summary["waiting_descriptors"])
        console.print(f"Without a grid, since too few motions defined them: {names}.")
    if summary["grids"] or summary["waiting_descriptors"]:
        for sentence in _report(summary).sentences():
            console.print(sentence, markup=False, highlight=False)
    if summary["llm"] == "none":
        console.print("Steered by the expert; the inferred condition here is the expert's own.")
        return
    sample = "" if summary["llm"] == "folder" else f"sample {summary['sample']}, "
    sentences = [f"Functionals: {sample}model {summary['model']}.", summary["provenance"]]
    if summary["usage"]:
        sentences.append(f"Usage: {summary['usage']}.")
    console.print(" ".join(sentences), markup=False, highlight=False)


def _report(summary: Summary) -> DescriptorReport:
    return DescriptorReport(
        same=tuple(map(tuple, summary["same_descriptors"])),
        degenerate=tuple(summary["degenerate_descriptors"]),
        undefined=tuple(summary["undefined_descriptors"]),
    )


def _figures(summary: Summary) -> Table:
    table = Table(title=f"{summary['task']} · {summary['method']} · seed {summary['seed']}",
                  box=box.SIMPLE_HEAD, show_header=False)  # fmt: skip
    table.add_column()
    table.add_column(justify="right")
    rejected, discarded = summary["rejected"], summary["discarded"]
    outcomes = summary["outcomes"]
    rows = [
        ("evaluations", summary["evaluations"]),
        ("rejected", sum(rejected.values())),
        *((f"  {cause}", count) for cause, count in rejected.items()),
        ("discarded", sum(discarded.values())),
        *((f"  {cause}", count) for cause, count in discarded.items()),
        ("valid", summary["valid"]),
        ("distinct elites", summary["archive_size"]),
        ("  inferred successes among them", summary["inferred_archive_size"]),
        ("success archive size (expert)", summary["success_archive_size"]),
        ("ground-truth cells", summary["ground_truth_cells"]),
        ("  successes outside that grid", summary["ground_truth_outside"]),
        ("distinct successes of the whole run", outcomes["both"] + outcomes["expert_only"]),
        ("  ground-truth cells", outcomes["ground_truth_cells"]),
        ("refused values", sum(row["count"] for row in summary["refused"])),
    ]
    if summary["grids"]:
        rows.append(("clipped measures", sum(grid["clipped"] for grid in summary["grids"])))
    rows.append(("seconds", round(summary["seconds"])))
    for name, value in rows:
        table.add_row(name, f"{value:,}")
    for name, found in summary["exploration"].items():
        kept = " (kept)" if name == summary["chosen_fitness"] else ""
        table.add_row(f"exploring {name}{kept}", f"{found:,}")
    return table


def _verdicts(summary: Summary) -> Table:
    """Return the confusion table of the inferred condition beside the expert's."""
    table = Table(
        title="Successes by the inferred and the expert's condition",
        box=box.SIMPLE_HEAD,
        padding=0,
        pad_edge=False,
    )
    table.add_column(no_wrap=True)
    for column in ("both", "inferred only", "expert only", "neither", "precision", "recall"):
        table.add_column(column, justify="right", no_wrap=True)
    for name, counts, neither in (
        ("valid motions", summary["confusion"], f"{summary['confusion']['neither']:,}"),
        ("distinct solutions", summary["outcomes"], ""),
    ):
        both, inferred, expert = counts["both"], counts["inferred_only"], counts["expert_only"]
        shares = (_share(both, both + inferred), _share(both, both + expert))
        table.add_row(name, f"{both:,}", f"{inferred:,}", f"{expert:,}", neither, *shares)
    return table


def _share(part: int, whole: int) -> str:
    return f"{part / whole:.1%}" if whole else "-"


def _grids(summary: Summary) -> Table:
    table = Table(title="Grids", box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0), pad_edge=False)
    table.add_column("descriptor", overflow="fold")
    for column in ("cells", "filled", "coverage", "successes", "clipped"):
        table.add_column(column, justify="right")
    moment = ""
    for grid in summary["grids"]:
        timestamp, _, quantity = grid["name"].partition(".")
        if quantity and timestamp != moment:
            moment = timestamp
            table.add_row(f"[bold]{timestamp}[/bold]")
        table.add_row(
            f"  {quantity}" if quantity else timestamp,
            f"{math.prod(grid['dims']):,}",
            f"{grid['filled']:,}",
            f"{grid['coverage']:.1%}",
            f"{grid['successes']:,}",
            f"{grid['clipped']:,}",
        )
    return table


def _refusals(summary: Summary) -> Table:
    table = Table(title="Refused values", box=box.SIMPLE_HEAD)
    for column in ("kind", "functional", "reason"):
        table.add_column(column, overflow="fold")
    table.add_column("count", justify="right")
    for row in summary["refused"]:
        table.add_row(row["kind"], row["functional"], row["reason"], f"{row['count']:,}")
    return table
