"""Where everything that is sent to a model and received from it is kept."""

import hashlib
import json
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from shutil import rmtree
from uuid import uuid4

import click

from lqd_envs import LQDError, Task
from lqd_envs.folder_lock import folder_locked
from lqd_search.cli.llm_options import LLMOptions

INFERENCE = "inference"
"""Name of the folder of requests and answers, within that of the functionals that came of them."""


@dataclass(frozen=True)
class KeptInference:
    """The folder in which an inference keeps its requests and answers until it is complete.

    Attributes:
        path: The folder, a hidden one beside the output.
    """

    path: Path

    def move_into(self, output: Path) -> None:
        """Move everything into the folder `inference` of the output, which is there.

        Raises:
            LQDError: It cannot be moved; it stays where it is.
        """
        try:
            self.path.rename(output / INFERENCE)
        except OSError as error:
            raise LQDError(
                f"Expected to move {self.path} to {output / INFERENCE}, but that failed "
                f"({error.strerror or error}); move it there yourself."
            ) from error

    def remove(self) -> None:
        """Remove the folder, once what is in it was copied to the output."""
        rmtree(self.path, ignore_errors=True)


@contextmanager
def keep_inference(
    output: Path, task: Task, *, llm: LLMOptions, instruction: str, sample: int
) -> Iterator[KeptInference]:
    """Keep what is asked and answered in a hidden folder beside an output.

    Where a model is asked, the folder's name is made from what is asked: when this ends before the
    folder is moved into the output, it stays, and the next try goes on from there. Recordings can
    be had again at any time, so their folder is new and goes with a failure.

    Args:
        output: The folder that is made in the end.
        task: The task.
        llm: What answers.
        instruction: The task in one sentence.
        sample: Which of several inferences.

    Raises:
        LQDError: The folder cannot be made, or another process asks the same.
    """
    beside = output.parent
    try:
        was_there = beside.exists()
    except OSError as error:
        raise _cannot_keep(beside, error) from error
    name = _hidden_name(task, llm=llm, instruction=instruction, sample=sample)
    place = _lasting(beside / name) if llm.asks_a_model else _passing(beside)
    try:
        with place as path:
            yield KeptInference(path)
    except BaseException:
        if not was_there:
            with suppress(OSError):
                # Where it is empty, nobody needs it.
                beside.rmdir()
        raise


@contextmanager
def _lasting(path: Path) -> Iterator[Path]:
    with _only_one(path):
        try:
            yield path
        except BaseException:
            _leave(path)
            raise


@contextmanager
def _passing(beside: Path) -> Iterator[Path]:
    path = beside / f".inference-{uuid4().hex[:16]}"
    try:
        yield path
    except BaseException:
        rmtree(path, ignore_errors=True)
        raise


def _hidden_name(task: Task, *, llm: LLMOptions, instruction: str, sample: int) -> str:
    asked = {"task": task.id, "instruction": instruction, "sample": sample, **llm.asked()}
    text = json.dumps(asked, sort_keys=True)
    return f".inference-{hashlib.sha256(text.encode()).hexdigest()[:16]}"


@contextmanager
def _only_one(path: Path) -> Iterator[None]:
    """Make a folder, or find it, and let nobody else in."""
    with ExitStack() as stack:
        try:
            alone = stack.enter_context(folder_locked(path))
        except OSError as error:
            raise _cannot_keep(path, error) from error
        if not alone:
            raise LQDError(
                f"Expected to be the only one to ask this, but another process keeps its answers "
                f"in {path}; wait for it, take another --sample, or name another folder with --out."
            )
        yield


def _cannot_keep(path: Path, error: OSError) -> LQDError:
    return LQDError(
        f"Expected to keep the model's answers in {path}, but that failed "
        f"({error.strerror or error}); choose another place with --out."
    )


def _leave(path: Path) -> None:
    """Leave what was paid for, and nothing else."""
    if not path.is_dir():
        return
    if not any(path.iterdir()):
        path.rmdir()
        return
    click.echo(
        f"note: the answers that came are kept in {path} and used when the same is asked again",
        err=True,
    )
