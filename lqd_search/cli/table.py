"""A run's figures as a table."""

import math

from rich import box
from rich.console import Console
from rich.table import Table

from lqd_search.runs.summary import Summary


def print_summary(summary: Summary) -> None:
    """Print the contents of a run's `summary.json` on standard output."""
    console = Console()
    console.print(_figures(summary))
    console.print(_grids(summary))
    if summary["refused"]:
        console.print(_refusals(summary))
    for sentence in summary["dropped"]:
        console.print(f"Not used: {sentence}", markup=False)
    if summary["waiting_descriptors"]:
        console.print(
            "Without a grid, since too few motions defined them: "
            + ", ".join(summary["waiting_descriptors"])
        )
    console.print(
        f"Functionals: recorded sample {summary['sample']}, model {summary['model']}. "
        f"{summary['provenance']}",
        markup=False,
        highlight=False,
    )


def _figures(summary: Summary) -> Table:
    table = Table(title=f"{summary['task']} · {summary['method']} · seed {summary['seed']}",
                  box=box.SIMPLE_HEAD, show_header=False)  # fmt: skip
    table.add_column()
    table.add_column(justify="right")
    rejected, discarded = summary["rejected"], summary["discarded"]
    confusion = summary["confusion"]
    rows = [
        ("evaluations", summary["evaluations"]),
        ("rejected", sum(rejected.values())),
        *((f"  {cause}", count) for cause, count in rejected.items()),
        ("discarded", sum(discarded.values())),
        *((f"  {cause}", count) for cause, count in discarded.items()),
        ("valid", summary["valid"]),
        ("  successes by both conditions", confusion["both"]),
        ("  by the inferred condition only", confusion["inferred_only"]),
        ("  by the expert's condition only", confusion["expert_only"]),
        ("distinct elites", summary["archive_size"]),
        ("  inferred successes among them", summary["inferred_archive_size"]),
        ("success archive size (expert)", summary["success_archive_size"]),
        ("ground-truth cells", summary["ground_truth_cells"]),
        ("  successes outside that grid", summary["ground_truth_outside"]),
        ("refused values", sum(row["count"] for row in summary["refused"])),
        ("clipped measures", sum(grid["clipped"] for grid in summary["grids"])),
        ("seconds", round(summary["seconds"])),
    ]
    for name, value in rows:
        table.add_row(name, f"{value:,}")
    for name, found in summary["exploration"].items():
        kept = " (kept)" if name == summary["chosen_fitness"] else ""
        table.add_row(f"exploring {name}{kept}", f"{found:,}")
    return table


def _grids(summary: Summary) -> Table:
    table = Table(title="Grids", box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0), pad_edge=False)
    table.add_column("descriptor", overflow="fold")
    for column in ("cells", "filled", "coverage", "successes", "clipped"):
        table.add_column(column, justify="right")
    moment = ""
    for grid in summary["grids"]:
        timestamp, _, quantity = grid["name"].partition(".")
        if timestamp != moment:
            moment = timestamp
            table.add_row(f"[bold]{timestamp}[/bold]")
        table.add_row(
            f"  {quantity}",
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
