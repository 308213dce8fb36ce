"""Keeping every answer as soon as it comes, and never asking for it twice."""

from pathlib import Path

from lqd_llm.answer import Answer
from lqd_llm.exchange_folder import ExchangeFolder, is_usable
from lqd_llm.provider import Provider
from lqd_llm.request import Request


class KeepingProvider:
    """Asks another provider, and keeps what it answers in a folder.

    Over a `LiveProvider` and a folder of recordings it takes recordings, which a `ReplayProvider`
    finds there. Over any provider and the folder of a run it keeps the run's transcript, from which
    a run that was interrupted goes on.

    An answer that the folder has is used again, unless no reply can be read from it: after a
    refusal, or a reply that was cut, the same is asked anew. To ask anew in any case, name another
    folder.

    Args:
        provider: What is asked where the folder has no answer.
        folder: The folder; it is made when the first answer comes.
    """

    def __init__(self, provider: Provider, *, folder: Path) -> None:
        self._provider = provider
        self._folder = ExchangeFolder(folder)

    def ask(self, request: Request) -> Answer:
        """Return the kept answer to a request, or ask and keep what is answered.

        Raises:
            ProviderError: The model could not be asked, or gave no answer.
            RecordingError: An answer cannot be read from the folder or written to it.
        """
        kept = self._folder.find(request)
        if kept is not None and is_usable(kept):
            return kept.answer
        answer = self._provider.ask(request)
        self._folder.write(request, answer)
        return answer
