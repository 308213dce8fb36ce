"""The author of the functionals: prompts, models and recordings that answer, checks and repairs.

What a model wrote is text here. It runs in `lqd_llm.sandbox`, a locked process of its own, and
never in the user's. (The project's tests and one benchmark also run the recordings that ship as
plain Python, to compare.)

The recordings that ship with the package are replies of a real Claude model, unedited. They were
taken outside the API, so there is no request id, no usage and no exact model name. Each kind was
asked in a conversation of its own, which answered that kind for the four tasks one after another.
Say so wherever results that rest on them are shown; `InferredFunctionals.provenance` does.
"""

from typing import TYPE_CHECKING, Any

from lqd_llm.answer import Answer
from lqd_llm.check import Candidate, CheckFailure, CheckFunction, CheckOutcome
from lqd_llm.errors import (
    FunctionError,
    InferenceError,
    MissingRecordingError,
    ModelOptionsError,
    PromptError,
    ProviderError,
    RecordingError,
    ReplyError,
)
from lqd_llm.exchange_folder import ExchangeFolder
from lqd_llm.function_check import FunctionCheck
from lqd_llm.functions import InferredFunction
from lqd_llm.inference import infer
from lqd_llm.inferred_functionals import DirectFunctionals, InferredFunctionals
from lqd_llm.keeping_provider import KeepingProvider
from lqd_llm.model_options import DEFAULT_MODEL, EFFORTS, ModelOptions
from lqd_llm.perception_layout import perception_layout
from lqd_llm.prompts import COUNTS, KINDS, prompt_hash, render_prompt, render_system
from lqd_llm.provider import Provider
from lqd_llm.recorded_code import is_recorded, recorded_sources
from lqd_llm.recordings import Exchange, Recording, available_samples, load_recording
from lqd_llm.replay_provider import ReplayProvider
from lqd_llm.reply import FunctionSource, Reply
from lqd_llm.request import Request
from lqd_llm.set_remarks import remarks
from lqd_llm.usage import Usage

if TYPE_CHECKING:
    from lqd_llm.live_provider import LiveProvider

__all__ = [
    "COUNTS",
    "DEFAULT_MODEL",
    "EFFORTS",
    "KINDS",
    "Answer",
    "Candidate",
    "CheckFailure",
    "CheckFunction",
    "CheckOutcome",
    "DirectFunctionals",
    "Exchange",
    "ExchangeFolder",
    "FunctionCheck",
    "FunctionError",
    "FunctionSource",
    "InferenceError",
    "InferredFunction",
    "InferredFunctionals",
    "KeepingProvider",
    "LiveProvider",
    "MissingRecordingError",
    "ModelOptions",
    "ModelOptionsError",
    "PromptError",
    "Provider",
    "ProviderError",
    "Recording",
    "RecordingError",
    "ReplayProvider",
    "Reply",
    "ReplyError",
    "Request",
    "Usage",
    "available_samples",
    "infer",
    "is_recorded",
    "load_recording",
    "perception_layout",
    "prompt_hash",
    "recorded_sources",
    "remarks",
    "render_prompt",
    "render_system",
]


def __getattr__(name: str) -> Any:
    # The Anthropic SDK takes seconds to import, and only who asks a model needs it.
    if name == "LiveProvider":
        from lqd_llm.live_provider import LiveProvider

        return LiveProvider
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
