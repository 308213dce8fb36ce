"""`lqd infer`: from a task's instruction to functionals that can be read."""

import os
from pathlib import Path

import click

from lqd_envs import LQDError, Task, get_task
from lqd_search.cli.checked_functionals import CheckedFunctionals, infer_functionals
from lqd_search.cli.kept_inference import keep_inference
from lqd_search.cli.llm_options import LLMOptions, llm_options
from lqd_search.cli.shown_functionals import functionals_lines
from lqd_search.runs.default_path import default_path
from lqd_search.runs.functionals_folder import write_functionals
from lqd_search.runs.functionals_index import Origin


@click.command("infer")
@click.argument("task_id", metavar="TASK")
@llm_options
@click.option(
    "--threads",
    type=click.IntRange(min=0),
    default=0,
    help="Threads to simulate example motions on.  [default: one for each CPU]",
)
@click.option(
    "--allow-weak-sandbox",
    is_flag=True,
    help="Run what the model wrote even where the sandbox lacks a layer; `lqd doctor` says whether "
    "it does.",
)
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    help="Folder for the functionals, which must not exist yet; a person may edit them, and "
    "`lqd run --functionals` uses them.  [default where a model is asked: inferred/<task>-<time>]",
)
def infer_command(
    *,
    task_id: str,
    llm: LLMOptions,
    instruction: str | None,
    sample: int,
    threads: int,
    allow_weak_sandbox: bool,
    out: Path | None,
) -> None:
    """Show the functionals that a language model writes for TASK, and what the checks said.

    Without further options, the model's replies are those that ship with the package. With --llm
    live a model is asked through the Anthropic API, which needs a key in ANTHROPIC_API_KEY and
    costs money. Nothing that it wrote is run outside of the sandbox.
    """
    task = get_task(task_id)
    asked = task.instruction if instruction is None else instruction
    output = out or (default_path(task, parent="inferred") if llm.asks_a_model else None)

    def infer(transcript: Path | None) -> CheckedFunctionals:
        return infer_functionals(
            task,
            llm=llm,
            instruction=asked,
            sample=sample,
            threads=threads,
            allow_weak=allow_weak_sandbox,
            transcript=transcript,
        )

    if output is None:
        _show(task, asked, infer(None))
        return
    _refuse_existing(output)
    with keep_inference(output, task, llm=llm, instruction=asked, sample=sample) as kept:
        checked = infer(kept.path)
        origin = Origin(asked, checked.model, checked.provenance, dict(checked.prompt_hashes))
        write_functionals(output, checked.texts, origin=origin)
        kept.move_into(output)
    _show(task, asked, checked)
    click.echo(f"\nFunctionals: {output}")


def _show(task: Task, instruction: str, checked: CheckedFunctionals) -> None:
    click.echo(f"{task.id} \u201c{instruction}\u201d\n")
    for line in functionals_lines(checked):
        click.echo(line)


def _refuse_existing(path: Path) -> None:
    if os.path.lexists(path):
        raise LQDError(
            f"Expected a new folder for the functionals, but {path} exists; name another with "
            "--out."
        )
