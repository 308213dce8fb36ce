"""The report on archives and instances: Markdown, CSV and pictures."""

import csv
import io
from pathlib import Path

from benchmarks.instances.candidates import most_looked_at
from benchmarks.instances.declared import FILTERS
from benchmarks.instances.description import describe, describe_making
from benchmarks.instances.figures import RANDOM, Figure, FixedMotion, SomeMotion
from benchmarks.instances.kind_tables import kind_section
from benchmarks.instances.overview import overview
from benchmarks.instances.results import Results
from benchmarks.instances.size_picture import draw_sizes
from benchmarks.instances.store import cannot_write
from benchmarks.tables.figure_files import figure_files
from lqd_envs import get_task
from lqd_envs.atomic_file import write_atomically
from lqd_search.methods.steering import STEERING

_HEAD = (
    *("task", "kind", "method", "steering", "filter", "figure", "choice", "tries", "size"),
    *("among", "runs", "instances", "value", "low", "high"),
)


def write_report(out: Path, results: Results) -> list[Path]:
    """Write `instances.md`, `instances.csv` and the pictures.

    Args:
        out: The folder.
        results: The judgements.

    Returns:
        The files.

    Raises:
        InstancesError: One of them cannot be written.
    """
    pictures: dict[str, bytes] = {}
    for task in results.tasks:
        pictures.update(figure_files(_picture(task), draw_sizes(results, task)))
    parts = ["# Task instances", describe(results), "## At a glance", overview(results)]
    for task in results.tasks:
        parts += [f"## {task}", f"![archives by size](pictures/{_picture(task)}.png)"]
        for kind in results.kinds:
            parts += [f"### {kind.capitalize()}", kind_section(results, task, kind)]
    parts += ["## How it was judged", describe_making(results)]
    files = {
        out / "instances.md": ("\n\n".join(parts) + "\n").encode(),
        out / "instances.csv": long_form(results).encode(),
        **{out / "pictures" / name: content for name, content in pictures.items()},
    }
    for path, content in files.items():
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            write_atomically(path, content)
        except OSError as error:
            raise cannot_write(path, error) from error
    return list(files)


def long_form(results: Results) -> str:
    """Return a CSV table with a row for each rate."""
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(_HEAD)
    for task, kind in results.instances:
        instances = len(results.solvable(task, kind))
        for method in results.methods(task):
            runs = len(results.runs(task, method))
            for by in FILTERS:
                capped = results.capped(task, kind, by, methods=[method])
                for figure, rate in results.rates(task, kind, method, by).items():
                    ends = ["" if end != end else end for end in (rate.low, rate.high)]
                    writer.writerow(
                        (
                            *(task, kind, method, STEERING[method], by, *_named(figure)),
                            _among(figure, cap=results.cap) if capped else "all",
                            *(runs, instances, rate.value, *ends),
                        )
                    )
    return text.getvalue()


def _picture(task: str) -> str:
    return f"sizes.{get_task(task).name}"


def _named(figure: Figure) -> tuple[str, str, int | str, int | str]:
    if isinstance(figure, FixedMotion):
        return ("one fixed motion", figure.choice, "", "whole")
    size = "whole" if figure.size is None else figure.size
    if isinstance(figure, SomeMotion):
        return ("some motion", "", "", size)
    return ("success", figure.selector, figure.tries, size)


def _among(figure: Figure, *, cap: int) -> str:
    if isinstance(figure, FixedMotion) or figure == SomeMotion():
        return f"at most {most_looked_at(cap)} looked at"
    if isinstance(figure, SomeMotion) or figure.size is not None or figure.selector == RANDOM:
        return f"at most {cap} drawn"
    # A selector chooses from all, and what it chooses is looked at.
    return "all"
