"""A folder of requests and their answers, one readable file each."""

import json
import os
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryFile
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from lqd_envs.atomic_file import write_atomically
from lqd_envs.folder_lock import folder_in_turn
from lqd_llm.answer import Answer, is_complete
from lqd_llm.errors import ModelOptionsError, RecordingError
from lqd_llm.form_problem import FormProblem
from lqd_llm.model_options import Effort, ModelOptions
from lqd_llm.request import Request, Turn
from lqd_llm.usage import Usage, total_usage

# More than an answer takes; a full disk still lets an empty file be made.
_ROOM = 1 << 20

_FILE_NAME = re.compile(r"[0-9a-f]{64}(\.[1-9][0-9]*)?\.json")


class _Form(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True)


class _TurnForm(_Form):
    role: Literal["user", "assistant"]
    content: str


class _SentForm(_Form):
    model: str
    effort: Effort | None
    max_tokens: int
    system: str
    messages: list[_TurnForm]
    reply_schema: dict[str, Any] = Field(alias="schema")
    sample: int
    attempt: int


class _ReceivedForm(_Form):
    provenance: str
    request_id: str | None
    date: str | None
    body: Any


class _ExchangeForm(_Form):
    key: str
    subject: str
    sent: _SentForm
    received: _ReceivedForm


@dataclass(frozen=True)
class KeptExchange:
    """A request and its answer, as a file holds them.

    Attributes:
        file_name: Name of the file.
        request: What was asked.
        answer: What came back.
    """

    file_name: str
    request: Request
    answer: Answer


class ExchangeFolder:
    """Requests and their answers, each in a file named after the request's key.

    An answer from which no reply can be read, such as a refusal, is kept like any other. When the
    same is asked again and answered, it is moved aside to `<key>.1.json` and so on, so that nothing
    that came is ever lost. Several processes may write in one folder.

    Args:
        path: The folder; it is made when the first answer is written.
    """

    def __init__(self, path: Path) -> None:
        self.path = path

    def find(self, request: Request) -> KeptExchange | None:
        """Return the latest exchange of a request, or None.

        Raises:
            RecordingError: Its file cannot be read, is not of the right form, or answers another
                request than its name says.
        """
        path = self._file(request)
        return _read(path) if _is_there(path) else None

    def write(self, request: Request, answer: Answer) -> None:
        """Write an answer at once and as a whole; an earlier one is moved aside.

        Raises:
            RecordingError: The file cannot be written.
        """
        path = self._file(request)
        try:
            # Another process may have asked the same, and come to write it now. What is held is
            # the folder above: this one is, for as long as it asks, by who keeps a transcript.
            with folder_in_turn(self.path.parent):
                self.path.mkdir(exist_ok=True)
                if path.exists():
                    path.rename(self._aside(request))
                write_atomically(path, _content(request, answer))
        except OSError as error:
            raise RecordingError(
                f"The answer to the {request.subject} prompt cannot be written to {self.path} "
                f"({error.strerror or error}); make room there or name another folder."
            ) from error

    def require_writable(self) -> None:
        """See whether answers can be written here, before one is paid for; it leaves no trace.

        Raises:
            RecordingError: They cannot.
        """
        above = (self.path, *self.path.absolute().parents)
        try:
            there = next(path for path in above if _exists(path))
            with TemporaryFile(dir=there) as file:
                file.write(bytes(_ROOM))
                file.flush()
                os.fsync(file.fileno())
        except OSError as error:
            raise RecordingError(
                f"Expected a folder that answers can be written to, but {self.path} is none "
                f"({error.strerror or error}); make room there or name another folder."
            ) from error

    def exchanges(self) -> Iterator[KeptExchange]:
        """Yield all exchanges by file name, those that were moved aside included.

        Raises:
            RecordingError: A file cannot be read or is not of the right form.
        """
        for path in _listed(self.path):
            if _FILE_NAME.fullmatch(path.name):
                yield _read(path)

    def usage(self) -> Usage:
        """Return the sum of what all answers took, those that were moved aside included.

        Raises:
            RecordingError: A file cannot be read or is not of the right form.
        """
        return total_usage([exchange.answer.usage for exchange in self.exchanges()])

    def _file(self, request: Request) -> Path:
        return self.path / f"{request.key}.json"

    def _aside(self, request: Request) -> Path:
        number = 1
        while (path := self.path / f"{request.key}.{number}.json").exists():
            number += 1
        return path


def _is_there(path: Path) -> bool:
    try:
        return _exists(path)
    except OSError as error:
        raise _unreadable(path, error) from error


def _exists(path: Path) -> bool:
    """Return whether there is a file; unlike `Path.exists`, an error is one in all versions."""
    try:
        path.stat()
    except (FileNotFoundError, NotADirectoryError):
        return False
    return True


def _listed(path: Path) -> list[Path]:
    try:
        return sorted(path.iterdir())
    except (FileNotFoundError, NotADirectoryError):
        return []
    except OSError as error:
        raise RecordingError(
            f"The folder {path} of recordings cannot be read ({error.strerror or error}); see to "
            "its permissions, or name another folder."
        ) from error


def is_usable(exchange: KeptExchange) -> bool:
    """Return whether a reply can be read from the answer of an exchange."""
    return is_complete(exchange.answer, request=exchange.request)


def _content(request: Request, answer: Answer) -> bytes:
    options = request.options
    content: Mapping[str, Any] = {
        "key": request.key,
        "subject": request.subject,
        "sent": {
            "model": options.model,
            "effort": options.effort,
            "max_tokens": options.max_tokens,
            "system": request.system,
            "messages": [{"role": turn.role, "content": turn.text} for turn in request.messages],
            "schema": request.schema,
            "sample": request.sample,
            "attempt": request.attempt,
        },
        "received": {
            "provenance": answer.provenance,
            "request_id": answer.request_id,
            "date": answer.date,
            "body": answer.body,
        },
    }
    # Plain ASCII, because what a model sends may hold half a surrogate pair.
    return f"{json.dumps(content, indent=1)}\n".encode("ascii")


def _read(path: Path) -> KeptExchange:
    try:
        form = _ExchangeForm.model_validate(json.loads(path.read_bytes()))
        request = _request(form)
    except OSError as error:
        raise _unreadable(path, error) from error
    except ValidationError as error:
        raise _malformed(path, f"at {FormProblem.first(error)}") from error
    except (ValueError, RecursionError) as error:
        raise _malformed(path, f"since it is not JSON ({error})") from error
    except ModelOptionsError as error:
        raise _malformed(path, f"at sent: {error}") from error
    if form.key != request.key or not path.name.startswith(request.key):
        raise _malformed(path, f"since what was sent has the key {request.key}")
    received = form.received
    answer = Answer(
        body=received.body,
        provenance=received.provenance,
        request_id=received.request_id,
        date=received.date,
    )
    return KeptExchange(file_name=path.name, request=request, answer=answer)


def _request(form: _ExchangeForm) -> Request:
    sent = form.sent
    return Request(
        subject=form.subject,
        options=ModelOptions(model=sent.model, effort=sent.effort, max_tokens=sent.max_tokens),
        system=sent.system,
        messages=tuple(Turn(role=turn.role, text=turn.content) for turn in sent.messages),
        sample=sent.sample,
        attempt=sent.attempt,
        schema=sent.reply_schema,
    )


def _unreadable(path: Path, error: OSError) -> RecordingError:
    return RecordingError(
        f"The recording {path.name} cannot be read ({error.strerror or error}); restore or remove "
        "the file."
    )


def _malformed(path: Path, problem: str) -> RecordingError:
    return RecordingError(
        f"The recording {path.name} is not of the right form {problem}; restore or remove the file."
    )
