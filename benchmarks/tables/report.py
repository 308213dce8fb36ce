"""The report of a benchmark: Markdown, CSV and pictures, from its finished cells alone."""

from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

from benchmarks.tables.box_picture import draw_boxes
from benchmarks.tables.cell import RECORDINGS
from benchmarks.tables.cell_figures import CellFigures
from benchmarks.tables.comparison_table import comparison_section
from benchmarks.tables.curve_picture import draw_curves
from benchmarks.tables.figure_files import figure_files
from benchmarks.tables.long_form import long_form
from benchmarks.tables.made_on import describe_made_on
from benchmarks.tables.paper_figures import PaperFigures
from benchmarks.tables.results import Results
from benchmarks.tables.study import Study
from benchmarks.tables.task_tables import condition_table, final_archive_table, outcome_table
from lqd_envs.atomic_file import write_atomically

_WHAT_COUNTS = (
    "Successes are those of the expert's condition. The final archive is what a method puts out, "
    "the outcome archive all distinct successes that it met on its way, whatever became of them. "
    "docs/benchmarks.md has the measures, what was declared beforehand, and how far the intervals "
    "can be trusted."
)
_CURVES = (
    "The curves of the final archive show the one that is being filled at that time. Each short "
    "run of the fitness exploration fills its own, so that those of `ours` fall where one ends."
)

Sections = Callable[[Results], Mapping[str, str]]
"""Returns the sections of a report, by heading."""


def write_report(out: Path, results: Results, *, sections: Sections) -> list[Path]:
    """Write `tables.md`, `tables.csv` and the pictures.

    Args:
        out: The folder.
        results: The finished cells.
        sections: What stands in `tables.md` after its head.

    Returns:
        The files.
    """
    pictures = _pictures(results)
    parts = [f"# {results.study.title}, scale `{results.study.scale}`", describe(results)]
    for heading, text in sections(results).items():
        parts += [f"## {heading}", text]
    if pictures:
        names = [name for name in pictures if name.endswith(".png")]
        parts += ["## Pictures", _CURVES, "\n\n".join(f"![{n}](pictures/{n})" for n in names)]
    files = {
        out / "tables.md": ("\n\n".join(parts) + "\n").encode(),
        out / "tables.csv": long_form(results).encode(),
        **{out / "pictures" / name: content for name, content in pictures.items()},
    }
    (out / "pictures").mkdir(parents=True, exist_ok=True)
    for path, content in files.items():
        write_atomically(path, content)
    return list(files)


def table_sections(results: Results) -> Mapping[str, str]:
    """Return the sections of the paper's tables."""
    paper = PaperFigures.load()
    sections = {}
    for task in results.study.tasks:
        sections.update(
            task_sections(results, task, final=final_archive_table(results, task, paper=paper))
        )
    return {
        **sections,
        "The inferred success condition": condition_table(results),
        "Comparisons": comparison_section(results),
    }


def task_sections(results: Results, task: str, *, final: str) -> Mapping[str, str]:
    """Return the sections of a task: one line where none of its cells is finished.

    Args:
        results: The finished cells.
        task: Of the study.
        final: What is said of its final archives.
    """
    if not results.begun(task):
        return {task.capitalize(): "No cell of this task is finished."}
    return {
        f"{task.capitalize()}: the final archive": final,
        f"{task.capitalize()}: the outcome archive": outcome_table(results, task),
    }


def describe(results: Results) -> str:
    """Return what was run, on what, and how long it took."""
    study, cells = results.study, list(results.cells.values())
    seeds = ", ".join(map(str, study.seeds))
    sentences = [
        f"{len(cells)} of {len(study.cells)} cells are finished, of {study.evaluations:,} "
        f"evaluations each, {study.batch_size:,} a generation; seeds {seeds}, seed k with "
        f"recording k mod {RECORDINGS}{_crossed(study)}.",
        _WHAT_COUNTS,
    ]
    if cells:
        hours = sum(cell.seconds for cell in cells) / 3600
        sentences += [
            f"They took {hours:.1f} hours in all, each on one thread.",
            *describe_made_on(cells),
            _commits(cells),
            *dict.fromkeys(f"Model: {cell.model}. {cell.provenance}" for cell in cells),
        ]
    return "\n\n".join(sentences)


def _crossed(study: Study) -> str:
    crossed = sum(not study.compares(cell) for cell in study.cells)
    return f"; {crossed} cells beside them cross recordings and seeds" if crossed else ""


def _commits(cells: Iterable[CellFigures]) -> str:
    methods: dict[str, Counter[str]] = {}
    for cell in cells:
        methods.setdefault(cell.commit or "unknown", Counter())[cell.method] += 1
    if len(methods) == 1:
        return f"Commit: {next(iter(methods))}."
    listed = (
        f"{commit} ({', '.join(f'{method} {n}' for method, n in counts.items())})"
        for commit, counts in methods.items()
    )
    return f"Commits, with the number of cells: {'; '.join(listed)}."


def _pictures(results: Results) -> dict[str, bytes]:
    pictures: dict[str, bytes] = {}
    for task in results.study.tasks:
        if results.begun(task):
            pictures.update(figure_files(f"curves.{task}", draw_curves(results, task)))
            pictures.update(figure_files(f"boxes.{task}", draw_boxes(results, task)))
    return pictures
