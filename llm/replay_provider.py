"""Answering with recordings: no network, no key, the same answer every time."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from lqd_llm.answer import Answer
from lqd_llm.errors import MissingRecordingError
from lqd_llm.exchange_folder import ExchangeFolder
from lqd_llm.model_options import ModelOptions
from lqd_llm.recordings import available_samples, available_tasks, load_recording
from lqd_llm.request import Request, Turn
from lqd_llm.request_difference import compare


@dataclass(frozen=True)
class _Recorded:
    file_name: str
    request: Request
    answer: Answer
    any_model: bool


class ReplayProvider:
    """Answers with recordings: first with a user's own, then with those that ship.

    The user's own are files of a `KeepingProvider`, each of which answers the one request with its
    key. Those that ship were taken outside the API, which is why neither model nor schema is known:
    they answer the requests with their prompts and their sample, whatever the model, and no repair.

    Args:
        directory: Folder of own recordings; by default there are none.
    """

    def __init__(self, directory: Path | None = None) -> None:
        self._own = None if directory is None else ExchangeFolder(directory)

    def ask(self, request: Request) -> Answer:
        """Return the recorded answer to a request.

        Raises:
            MissingRecordingError: There is none; the message says how the nearest one differs.
            RecordingError: A recording cannot be read or is not of the right form.
        """
        own = None if self._own is None else self._own.find(request)
        if own is not None:
            return own.answer
        for recorded in self._shipped:
            if not compare(recorded.request, request, any_model=True).parts:
                return recorded.answer
        raise MissingRecordingError(self._missing(request))

    @cached_property
    def _shipped(self) -> tuple[_Recorded, ...]:
        return tuple(_shipped_recordings())

    def _missing(self, request: Request) -> str:
        sought = f"Found no recording of the {request.subject} prompt with the key {request.key}"
        own = [
            _Recorded(kept.file_name, kept.request, kept.answer, any_model=False)
            for kept in (() if self._own is None else self._own.exchanges())
        ]
        nearest, difference = min(
            (
                (recorded, compare(recorded.request, request, any_model=recorded.any_model))
                for recorded in (*own, *self._shipped)
            ),
            key=lambda pair: pair[1].distance,
        )
        return (
            f"{sought}; the nearest is {nearest.file_name}, but {', and '.join(difference.parts)}; "
            f"ask for what is recorded ({_recorded()}), ask a model with `--llm live` or "
            "`--llm record`, or write functionals of your own for `lqd run --functionals`."
        )


def _recorded() -> str:
    samples = sorted({sample for task in available_tasks() for sample in available_samples(task)})
    return (
        f"the instructions of the tasks {', '.join(available_tasks())}, with the samples "
        f"{', '.join(map(str, samples))}"
    )


def _shipped_recordings() -> Iterator[_Recorded]:
    numbered = ((task, sample) for task in available_tasks() for sample in available_samples(task))
    for task, sample in numbered:
        recording = load_recording(task, sample=sample)
        for kind, exchange in recording.exchanges.items():
            request = Request(
                subject=kind,
                options=ModelOptions(model=recording.model),
                system=recording.system,
                messages=(Turn("user", exchange.prompt),),
                sample=recording.sample,
            )
            # As the API would have sent it; it reported neither its usage nor an id.
            body = {
                "model": recording.model,
                "content": [{"type": "text", "text": exchange.reply.model_dump_json()}],
                "stop_reason": "end_turn",
            }
            answer = Answer(body=body, provenance=recording.provenance)
            yield _Recorded(f"{task}-{sample}.json", request, answer, any_model=True)
