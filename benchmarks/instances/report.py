"""The report on archives and instances: Markdown, CSV and pictures."""

import csv
import io
from pathlib import Path

from benchmarks.instances.declared import FILTERS, SUBSETS
from benchmarks.instances.figures import Figure, SomeMotion
from benchmarks.instances.kind_tables import kind_section
from benchmarks.instances.results import Results
from benchmarks.instances.size_picture import draw_sizes
from benchmarks.instances.two_way import CONFIDENCE, RESAMPLES
from benchmarks.tables.figure_files import figure_files
from lqd_envs.atomic_file import write_atomically
from lqd_search.adaptation import SELECTORS

_HEAD = (
    *("task", "kind", "method", "filter", "figure", "choice", "tries", "size"),
    *("runs", "instances", "value", "low", "high"),
)


def write_report(out: Path, results: Results) -> list[Path]:
    """Write `instances.md`, `instances.csv` and the pictures.

    Args:
        out: The folder.
        results: The judgements.

    Returns:
        The files.
    """
    pictures: dict[str, bytes] = {}
    for task in results.tasks:
        pictures.update(figure_files(f"sizes.{_short(task)}", draw_sizes(results, task)))
    parts = ["# Task instances", describe(results)]
    for task in results.tasks:
        parts += [f"## {task}", f"![archives by size](pictures/sizes.{_short(task)}.png)"]
        for kind in results.kinds:
            parts += [f"### {kind.capitalize()}", kind_section(results, task, kind)]
    files = {
        out / "instances.md": ("\n\n".join(parts) + "\n").encode(),
        out / "instances.csv": long_form(results).encode(),
        **{out / "pictures" / name: content for name, content in pictures.items()},
    }
    (out / "pictures").mkdir(parents=True, exist_ok=True)
    for path, content in files.items():
        write_atomically(path, content)
    return list(files)


def describe(results: Results) -> str:
    """Return what was judged and how to read it."""
    evaluations = sorted({run.evaluations for run in results.judgements})
    selectors = "; ".join(f"`{s.name}`, {s.summary}" for s in SELECTORS.values())
    sentences = [
        f"{len(results.judgements)} runs of {' and '.join(f'{n:,}' for n in evaluations)} "
        "evaluations. A motion solves an instance if the task's expert calls it a success and what "
        "the instance asks is met, simulated in the scene of the instance.",
        "Motions are those of the archive that the inferred condition approves, which is all that a"
        " robot has, and beside them those that the expert approves. Selectors see neither the "
        f"instance nor the expert's word: {selectors}; `random` is the expectation of a random "
        "choice. The best single motion, the first choice of `best`, is the control.",
        f"In instances with obstacles and changes, at most {results.cap:,} motions of an archive "
        "are judged, drawn at random once for each run, and what selectors choose beside them: "
        "where more are there, the probability that some motion of the whole archive solves an "
        "instance is at least what is given. In the others all motions are judged.",
        "Of random subsets, the probability that some motion solves is exact; selectors choose from"
        f" {SUBSETS} random subsets of each size. An archive that is smaller is taken whole.",
        f"Brackets are {CONFIDENCE:.0%} intervals of {RESAMPLES:,} bootstrap resamples of runs and "
        "of instances. Where a method has a single run, they are of instances alone.",
    ]
    if results.different:
        sentences.append(
            f"{results.different:,} motions, simulated again in the task itself, were not bit for "
            "bit what their run saw: other versions or another processor made it."
        )
    return "\n\n".join(sentences)


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
                for figure, rate in results.rates(task, kind, method, by).items():
                    ends = ["" if end != end else end for end in (rate.low, rate.high)]
                    writer.writerow(
                        (
                            *(task, kind, method, by, *_named(figure)),
                            *(runs, instances, rate.value, *ends),
                        )
                    )
    return text.getvalue()


def _named(figure: Figure) -> tuple[str, str, int | str, int | str]:
    size = "whole" if figure.size is None else figure.size
    if isinstance(figure, SomeMotion):
        return ("some motion", "", "", size)
    return ("success", figure.selector, figure.tries, size)


def _short(task: str) -> str:
    return task.rpartition("/")[2].partition("-")[0].lower()
