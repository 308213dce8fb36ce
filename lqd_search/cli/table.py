"""A run's figures as a table."""

import math

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from lqd_search.runs.agreement import Agreement
from lqd_search.runs.summary import Summary
from lqd_search.runs.summary_figures import figures_of
from lqd_search.runs.summary_notes import descriptor_notes, functional_notes, steering_notes


def print_summary(summary: Summary) -> None:
    """Print the contents of a run's `summary.json` on standard output."""
    console = Console()
    console.print(_figures(summary))
    console.print(_verdicts(summary))
    if summary["grids"]:
        console.print(_grids(summary))
    if summary["refused"]:
        console.print(_refusals(summary))
    steering = steering_notes(summary)
    for sentence in (*functional_notes(summary), *descriptor_notes(summary), *steering):
        console.print(sentence, markup=False, highlight=False)
    if steering:
        return
    sample = "" if summary["llm"] == "folder" else f"sample {summary['sample']}, "
    sentences = [f"Functionals: {sample}model {summary['model']}.", summary["provenance"]]
    if summary["usage"]:
        sentences.append(f"Usage: {summary['usage']}.")
    console.print(" ".join(sentences), markup=False, highlight=False)


def _figures(summary: Summary) -> Table:
    title = f"{summary['task']} · {summary['method']} · seed {summary['seed']}"
    table = Table(title=Text(title, style="table.title"), box=box.SIMPLE_HEAD, show_header=False)
    table.add_column()
    table.add_column(justify="right")
    for figure in figures_of(summary):
        indented = f"  {figure.name}" if figure.under else figure.name
        table.add_row(Text(indented), f"{figure.value:,}")
    table.add_row("seconds", f"{summary['seconds']:,.0f}")
    for name, found in summary["exploration"].items():
        kept = " (kept)" if name == summary["chosen_fitness"] else ""
        table.add_row(Text(f"exploring {name}{kept}"), f"{found:,}")
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
        agreement = Agreement.of(counts)
        shares = (agreement.precision, agreement.recall)
        table.add_row(name, f"{both:,}", f"{inferred:,}", f"{expert:,}", neither, *shares)
    return table


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
            table.add_row(Text(timestamp, style="bold"))
        table.add_row(
            Text(f"  {quantity}" if quantity else timestamp),
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
        texts = (row["kind"], row["functional"], row["reason"])
        table.add_row(*map(Text, texts), f"{row['count']:,}")
    return table
