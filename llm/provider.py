"""What answers requests: a model, or recordings of one."""

from typing import Protocol

from lqd_llm.answer import Answer
from lqd_llm.request import Request


class Provider(Protocol):
    """Answers requests."""

    def ask(self, request: Request) -> Answer:
        """Return the answer to a request, whether or not a reply can be read from it.

        Raises:
            ProviderError: The model could not be asked, or gave no answer.
            RecordingError: Recordings answer, and they have none of this request.
        """
        ...
