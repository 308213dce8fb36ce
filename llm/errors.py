"""The errors that the authoring of functionals raises on purpose."""

from lqd_envs.errors import LQDError


class PromptError(LQDError):
    """A prompt was asked for that does not exist."""


class RecordingError(LQDError):
    """A recording is missing, is not of the right form, or answers other prompts."""


class FunctionError(LQDError):
    """A function of a reply cannot be built."""


class InferenceError(LQDError):
    """A reply leaves a kind of functional without any function."""
