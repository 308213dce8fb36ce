"""Keeping every answer as soon as it comes, and never asking for it twice."""

from collections.abc import Sequence
from pathlib import Path

from lqd_llm.answer import Answer
from lqd_llm.errors import RecordingError
from lqd_llm.exchange_folder import ExchangeFolder, is_usable
from lqd_llm.provider import Provider
from lqd_llm.request import Request


class KeepingProvider:
    """Asks another provider, and keeps what it answers in one folder or several.

    Over a `LiveProvider` and a folder of recordings it takes recordings, which a `ReplayProvider`
    finds there. Over any provider and the folder of a run it keeps the run's transcript, from which
    a run that was interrupted goes on.

    An answer that the folder has is used again, unless no reply can be read from it: after a
    refusal, or a reply that was cut, the same is asked anew. To ask anew in any case, name another
    folder.

    Args:
        provider: What is asked where the folder has no answer.
        folder: The folder; it is made when the first answer comes.
        copies: Other folders that hold the same: what one of them lacks is written there too.
            Where one cannot be written, the others are all the same, before that is an error.
    """

    def __init__(self, provider: Provider, *, folder: Path, copies: Sequence[Path] = ()) -> None:
        self._provider = provider
        self._folders = [ExchangeFolder(path) for path in (folder, *copies)]

    def ask(self, request: Request) -> Answer:
        """Return the kept answer to a request, or ask and keep what is answered.

        Raises:
            ProviderError: The model could not be asked, or gave no answer.
            RecordingError: An answer cannot be read from a folder or written to it. Whether it can
                be written is tried before the other provider is asked, which may cost money.
        """
        found = {folder: folder.find(request) for folder in self._folders}
        kept = {folder: its.answer for folder, its in found.items() if its and is_usable(its)}
        if kept:
            answer = next(iter(kept.values()))
        else:
            for folder in self._folders:
                folder.require_writable()
            answer = self._provider.ask(request)
        self._write([folder for folder in self._folders if folder not in kept], request, answer)
        return answer

    def _write(self, folders: Sequence[ExchangeFolder], request: Request, answer: Answer) -> None:
        failures: list[RecordingError] = []
        for folder in folders:
            try:
                folder.write(request, answer)
            except RecordingError as error:
                # The answer has been paid for: another folder may have room for it.
                failures.append(error)
        if failures:
            raise failures[0]
