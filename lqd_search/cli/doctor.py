"""`lqd doctor`: what this machine has, and how well the sandbox holds on it."""

import sys
from collections.abc import Sequence
from importlib.metadata import PackageNotFoundError
from pathlib import Path
from typing import TYPE_CHECKING

import click
import numpy as np

from lqd_envs import LQDError, get_task
from lqd_search.cli.corpus_trial import try_corpora
from lqd_search.cli.install import INSTALL_ALL
from lqd_search.cli.machine import machine_facts

if TYPE_CHECKING:
    from lqd_llm.sandbox import Layer

_FAILED = 1


@click.command("doctor")
@click.option(
    "--corpus",
    "corpora",
    metavar="FILE",
    multiple=True,
    type=click.Path(path_type=Path),
    help="Try the functions of this file in the sandbox, one JSON object a line; may be given "
    "several times.",
)
@click.option(
    "--task",
    "task_id",
    metavar="TASK",
    default="LQD/Grasp-v0",
    show_default=True,
    help="On whose example motions the functions of --corpus are called.",
)
@click.option(
    "--threads",
    type=click.IntRange(min=0),
    default=0,
    help="Threads to simulate these motions on.  [default: one for each CPU]",
)
@click.option(
    "--allow-weak-sandbox",
    is_flag=True,
    help="Run the functions of --corpus even where layers of the sandbox are missing.",
)
def doctor_command(
    *, corpora: tuple[Path, ...], task_id: str, threads: int, allow_weak_sandbox: bool
) -> None:
    """Say what this machine has, and which layers of the sandbox hold on it.

    Each layer is tried: a process locks itself in, and then does what must fail. A layer that is
    missing is no fault of the installation; the last sentence says what follows from it.

    With --corpus the functions of a file are tried instead, each in a sandbox of its own, and each
    line's outcome is printed beside the expected one. An outcome `ok` says that a function ran and
    gave values of the right kind, the same ones twice.

    The exit status is 0; 1 if a package or the sandbox itself does not work, or an outcome differs;
    2 if a file cannot be read or the functions cannot be run here.
    """
    if corpora:
        differing = _try(corpora, task_id=task_id, threads=threads, allow_weak=allow_weak_sandbox)
        works = differing == 0
    else:
        works = _report()
    if not works:
        sys.exit(_FAILED)


def _try(corpora: Sequence[Path], *, task_id: str, threads: int, allow_weak: bool) -> int:
    try:
        return try_corpora(corpora, get_task(task_id), threads=threads, allow_weak=allow_weak)
    except ImportError as error:
        raise LQDError(
            f"Expected the packages of the extra `llm` to try functions, but {error.name} is not "
            f"installed; {INSTALL_ALL}."
        ) from error


def _report() -> bool:
    """Print what there is, and return whether it works."""
    works = True
    try:
        _print_pairs(machine_facts())
    except PackageNotFoundError as error:
        click.echo(f"Broken: {error.name} is not installed; {INSTALL_ALL}.")
        works = False
    try:
        from lqd_llm.sandbox import probe_layers
    except ImportError as error:
        click.echo(f"\nWithout the extra `llm` there is no sandbox ({error.name} is missing).")
        return works
    click.echo("\nLayers of the sandbox")
    layers = probe_layers()
    for layer in layers:
        state = "holds" if layer.active else "MISSING"
        why = "" if layer.active else f"\n{'':26}{layer.why_not}"
        click.echo(f"  {layer.name:<14}{state:<10}{layer.purpose}{why}")
    broken = _why_it_does_not_calculate()
    click.echo("\n" + _conclusion(layers, broken=broken))
    return works and not broken


def _print_pairs(pairs: Sequence[tuple[str, str]]) -> None:
    width = max(len(name) for name, _ in pairs) + 2
    for name, value in pairs:
        click.echo(f"{name:<{width}}{value}")


def _why_it_does_not_calculate() -> str:
    """Have a worker calculate something, and return why that does not work; empty if it does."""
    from lqd_llm.sandbox import InfoLayout, Role, Sandbox, SandboxedFunction, check_source

    columns = {"flag": np.ones((1, 2), dtype=bool)}
    source = check_source("def total(info):\n    return 1.0 + info['flag']\n", entry="total")
    function = SandboxedFunction("total", Role.FITNESS, source)
    layout = InfoLayout.of(columns, names={})
    try:
        with Sandbox(layout, functions=[function], allow_weak=True) as sandbox:
            total = sandbox.run(columns).fitness["total"].tolist()
    except LQDError as error:
        return str(error)
    return "" if total == [2.0] else f"Expected 1 + 1 = 2 from the sandbox, but got {total}."


def _conclusion(layers: Sequence["Layer"], *, broken: str) -> str:
    if broken:
        return f"The sandbox does not work here: {broken}"
    missing = [layer.name for layer in layers if not layer.active]
    if not missing:
        return (
            "All layers hold: functions that a model has just written, or that somebody edited, "
            "run here."
        )
    return (
        f"Without {', '.join(missing)}: recorded functions run as ever, but those that a model has "
        "just written, or that somebody edited, run only with --allow-weak-sandbox."
    )
