"""Trying files of functions in the sandbox, as `lqd doctor --corpus` does."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
import numpy as np
from numpy.typing import NDArray

from lqd_envs import Task, rollout
from lqd_envs.tasks.examples import example_solutions

if TYPE_CHECKING:
    from lqd_llm.sandbox import CorpusOutcome
    from lqd_llm.sandbox.corpus import CorpusLine
    from lqd_llm.sandbox.info_layout import InfoLayout

_MOTIONS = 16
_NAME_WIDTH = 40
_LONGEST_DETAIL = 300


def try_corpora(files: Sequence[Path], task: Task, *, threads: int, allow_weak: bool) -> int:
    """Try the functions of some files, and print what comes of each as it comes.

    Args:
        files: The files, of one JSON object a line.
        task: On whose example motions the functions are called.
        threads: Threads to simulate these on; 0: one for each CPU.
        allow_weak: Whether to go on without layers that this system does not have.

    Returns:
        How many functions came to something else than is expected of them.

    Raises:
        LQDError: A file cannot be read, or the sandbox cannot be used.
    """
    from lqd_llm.sandbox import read_corpus, run_corpus

    # All are read before any is tried: a mistake in the last should not cost the first.
    corpora = {file: read_corpus(file) for file in files}
    layout, columns = _example_motions(task, threads=threads)
    differing: list[CorpusOutcome] = []
    for file, lines in corpora.items():
        click.echo(f"\n{file}: {_functions(len(lines))} on {_motions(columns)} of {task.id}")
        for outcome in run_corpus(lines, layout=layout, columns=columns, allow_weak=allow_weak):
            _print(outcome)
            if not outcome.as_expected:
                differing.append(outcome)
    _print_total(sum(map(len, corpora.values())), differing)
    return len(differing)


def _example_motions(
    task: Task, *, threads: int
) -> tuple["InfoLayout", Mapping[str, NDArray[Any]]]:
    """Return valid motions of a task, some that touch and move the object among them."""
    from lqd_llm import perception_layout

    trajectories = rollout(task, example_solutions(task), threads=threads)
    valid = np.flatnonzero(trajectories.valid)
    spread = np.linspace(0, len(valid) - 1, min(_MOTIONS, len(valid))).astype(np.intp)
    columns = trajectories.rows(valid[spread]).columns
    return perception_layout(task.schema), columns.arrays()


def _print(outcome: "CorpusOutcome") -> None:
    line = outcome.line
    text = f"{_plain(line.name):<{_NAME_WIDTH}} {outcome.outcome:<10} expected {_expected(line)}"
    if outcome.as_expected:
        click.echo(f"  {text}")
        return
    click.secho(f"! {text}   DIFFERS", fg="red", bold=True)
    if outcome.detail:
        click.echo(f"    {_plain(outcome.detail)[:_LONGEST_DETAIL]}")


def _expected(line: "CorpusLine") -> str:
    return line.expected + (f" (or {', '.join(line.also_ok)})" if line.also_ok else "")


def _print_total(lines: int, differing: Sequence["CorpusOutcome"]) -> None:
    if not differing:
        click.echo(f"\n{_functions(lines)}: all as expected.")
        return
    names = ", ".join(_plain(outcome.line.name) for outcome in differing)
    click.echo(f"\n{_functions(lines)}, {len(differing)} not as expected: {names}.")


def _motions(columns: Mapping[str, NDArray[Any]]) -> str:
    motions = len(next(iter(columns.values())))
    return f"{motions} example motion{'' if motions == 1 else 's'}"


def _functions(n: int) -> str:
    return f"{n} function{'' if n == 1 else 's'}"


def _plain(text: str) -> str:
    """Return text without what would move the cursor or cannot be encoded."""
    return "".join(c if c.isprintable() else "\N{REPLACEMENT CHARACTER}" for c in text)
