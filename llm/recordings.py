"""Recordings: replies of a real model, kept with the prompts that they answer."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path

from pydantic import BaseModel, ConfigDict, ValidationError

from lqd_llm.errors import RecordingError
from lqd_llm.form_problem import FormProblem
from lqd_llm.prompts import KINDS
from lqd_llm.reply import Reply

_FILE_NAME = re.compile(r"(?P<task>.+)-(?P<sample>0|[1-9][0-9]*)\.json")


@dataclass(frozen=True)
class Exchange:
    """One prompt and the reply to it.

    Attributes:
        prompt: The user's turn.
        reply: The functions that the model replied with.
    """

    prompt: str
    reply: Reply


@dataclass(frozen=True)
class Recording:
    """One sample of everything that is asked of a model for one task.

    Attributes:
        task: Short name of the task, such as `"faucet"`.
        sample: Number of the sample, from 0.
        model: The model, as far as it is known.
        provenance: How the replies were taken; shown wherever results rest on them.
        system: The system prompt, the same for every exchange.
        exchanges: One exchange for each of `lqd_llm.KINDS`.
    """

    task: str
    sample: int
    model: str
    provenance: str
    system: str
    exchanges: Mapping[str, Exchange]


class _ExchangeForm(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True)

    prompt: str
    reply: Reply


class _RecordingForm(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True)

    task: str
    sample: int
    model: str
    provenance: str
    system: str
    replies: dict[str, _ExchangeForm]


def available_tasks() -> tuple[str, ...]:
    """Return the short names of the tasks of which samples ship with the package, in order."""
    return tuple(_samples(_folder(None)))


def available_samples(task_name: str, *, directory: Path | None = None) -> tuple[int, ...]:
    """Return the numbers of a task's recorded samples, in order; none for an unknown task.

    Args:
        task_name: Short name of the task, such as `"faucet"`.
        directory: Folder of recordings; by default those that ship with the package.

    Raises:
        RecordingError: The folder cannot be read.
    """
    return _samples(_folder(directory)).get(task_name, ())


def load_recording(task_name: str, *, sample: int, directory: Path | None = None) -> Recording:
    """Load one recording.

    Args:
        task_name: Short name of the task, such as `"faucet"`.
        sample: Number of the sample.
        directory: Folder of recordings; by default those that ship with the package.

    Raises:
        RecordingError: There is no such recording, or its file cannot be read or is not of the
            right form.
    """
    folder = _folder(directory)
    samples = _samples(folder)
    if sample not in samples.get(task_name, ()):
        raise RecordingError(_missing(task_name, sample=sample, samples=samples))
    file = folder.joinpath(f"{task_name}-{sample}.json")
    try:
        form = _RecordingForm.model_validate_json(_content(file))
    except ValidationError as error:
        raise RecordingError(_malformed(file, f"at {FormProblem.first(error)}")) from error
    if (form.task, form.sample) != (task_name, sample):
        holds = f"it holds sample {form.sample} of the task {form.task!r}"
        raise RecordingError(_malformed(file, f"at task and sample: {holds}"))
    if set(form.replies) != set(KINDS):
        kinds = f"expected the kinds {', '.join(KINDS)}, got {', '.join(form.replies) or 'none'}"
        raise RecordingError(_malformed(file, f"at replies: {kinds}"))
    return Recording(
        task=form.task,
        sample=form.sample,
        model=form.model,
        provenance=form.provenance,
        system=form.system,
        exchanges={
            kind: Exchange(prompt=form.replies[kind].prompt, reply=form.replies[kind].reply)
            for kind in KINDS
        },
    )


def _folder(directory: Path | None) -> Traversable:
    return directory or resources.files("lqd_llm").joinpath("recordings")


def _samples(folder: Traversable) -> dict[str, tuple[int, ...]]:
    """Return the recorded samples of each task, both in order."""
    try:
        names = [file.name for file in folder.iterdir()] if folder.is_dir() else []
    except OSError as error:
        raise RecordingError(
            f"Expected a folder of recordings at {folder}, but it cannot be read "
            f"({error.strerror or error}); name another directory."
        ) from error
    matches = [match for name in names if (match := _FILE_NAME.fullmatch(name))]
    pairs = sorted((match["task"], int(match["sample"])) for match in matches)
    return {task: tuple(number for name, number in pairs if name == task) for task, _ in pairs}


def _content(file: Traversable) -> bytes:
    try:
        return file.read_bytes()
    except OSError as error:
        raise RecordingError(
            f"The recording {file.name} cannot be read ({error.strerror or error}); restore the "
            "file."
        ) from error


def _missing(task_name: str, *, sample: int, samples: Mapping[str, tuple[int, ...]]) -> str:
    sought = f"Found no recording of the task {task_name!r} with sample {sample}"
    if task_name in samples:
        numbers = ", ".join(map(str, samples[task_name]))
        return f"{sought}; recorded samples of {task_name!r}: {numbers}; ask for one of these."
    return (
        f"{sought}; no sample of {task_name!r} is recorded, and the recorded tasks are "
        f"{', '.join(samples) or 'none'}; ask for one of these or name another directory."
    )


def _malformed(file: Traversable, problem: str) -> str:
    return f"The recording {file.name} is not of the right form {problem}; restore the file."
