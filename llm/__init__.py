"""The author of the functionals: prompts, recorded replies, parsing, checking and building.

The recordings that ship with the package are replies of a real Claude model, unedited. They were
taken outside the API, so there is no request id, no usage and no exact model name. Each kind was
asked in a conversation of its own, which answered that kind for the four tasks one after another.
Say so wherever results that rest on them are shown; `InferredFunctionals.provenance` does.
"""

from lqd_llm.errors import FunctionError, InferenceError, PromptError, RecordingError
from lqd_llm.functions import InferredFunction, build_function
from lqd_llm.inference import DirectFunctionals, InferredFunctionals, infer_from_recording
from lqd_llm.prompts import COUNTS, KINDS, prompt_hash, render_prompt, render_system
from lqd_llm.recordings import Exchange, Recording, available_samples, load_recording
from lqd_llm.reply import FunctionSource, Reply

__all__ = [
    "COUNTS",
    "KINDS",
    "DirectFunctionals",
    "Exchange",
    "FunctionError",
    "FunctionSource",
    "InferenceError",
    "InferredFunction",
    "InferredFunctionals",
    "PromptError",
    "Recording",
    "RecordingError",
    "Reply",
    "available_samples",
    "build_function",
    "infer_from_recording",
    "load_recording",
    "prompt_hash",
    "render_prompt",
    "render_system",
]
