"""The requests of one inference, asked one after another."""

from lqd_llm.answer import Answer, read_reply
from lqd_llm.model_options import ModelOptions
from lqd_llm.provider import Provider
from lqd_llm.reply import Reply
from lqd_llm.request import Request, Turn
from lqd_llm.usage import Usage, total_usage


class Inquiry:
    """Asks a provider for everything that one inference needs, and keeps what it answered.

    Args:
        provider: What answers.
        options: Which model is asked, and how.
        system: The system prompt of all requests.
        sample: Which of several answers to the same prompts is wanted.
    """

    def __init__(
        self, provider: Provider, *, options: ModelOptions, system: str, sample: int
    ) -> None:
        self._provider = provider
        self._options = options
        self._system = system
        self._sample = sample
        self._answers: list[Answer] = []

    def ask(self, prompt: str, *, subject: str, attempt: int = 0) -> Reply:
        """Ask one prompt, in a conversation of its own.

        Args:
            prompt: The user's turn.
            subject: What is asked for, in a word or two; errors name it.
            attempt: 0 for a first answer; from 1 on, which repair of a function it is.

        Raises:
            ProviderError: The model could not be asked, or gave no answer.
            ReplyError: The model refused, its reply was cut, or it is not of the right form.
            RecordingError: Recordings answer, and they have none of this request.
        """
        request = Request(
            subject=subject,
            options=self._options,
            system=self._system,
            messages=(Turn("user", prompt),),
            sample=self._sample,
            attempt=attempt,
        )
        answer = self._provider.ask(request)
        self._answers.append(answer)
        return read_reply(answer, request=request)

    @property
    def usage(self) -> Usage:
        """What all answers took, those that could not be read included."""
        return total_usage([answer.usage for answer in self._answers])

    @property
    def model(self) -> str:
        """The model that answered, as far as it is known; several where they differ."""
        return ", ".join(dict.fromkeys(answer.model for answer in self._answers))

    @property
    def provenance(self) -> str:
        """How the answers were taken."""
        return " ".join(dict.fromkeys(answer.provenance for answer in self._answers))
