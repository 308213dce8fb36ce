"""The errors that the authoring of functionals raises on purpose."""

from lqd_envs.errors import LQDError


class PromptError(LQDError):
    """A prompt was asked for that does not exist."""


class ModelOptionsError(LQDError):
    """An option of the model that is asked has a value that it cannot have."""


class RecordingError(LQDError):
    """A recording is missing, is not of the right form, or answers other prompts."""


class MissingRecordingError(RecordingError):
    """A request was to be answered by a recording, and there is none of it."""


class FunctionError(LQDError):
    """A function of a reply cannot be used."""


class InferenceError(LQDError):
    """Inference gave no functionals: a kind of them is left without any function."""


class ProviderError(InferenceError):
    """The model could not be asked, or gave no answer."""


class ReplyError(InferenceError):
    """The model's answer holds no functions: it is refused, cut, or of another form."""
