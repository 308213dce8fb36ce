"""Running functions that a language model wrote, where they can do no harm.

It knows nothing of prompts, models, searches or tasks: others could lift it out.
"""

from lqd_llm.sandbox.corpus import CorpusLine, CorpusOutcome, read_corpus, run_corpus
from lqd_llm.sandbox.errors import RejectedCodeError, SandboxError
from lqd_llm.sandbox.functions import SandboxedFunction
from lqd_llm.sandbox.info_layout import InfoKey, InfoLayout
from lqd_llm.sandbox.layers import Layer, probe_layers
from lqd_llm.sandbox.limits import Limits
from lqd_llm.sandbox.results import DroppedFunction, RefusedValues, Results
from lqd_llm.sandbox.roles import Role
from lqd_llm.sandbox.sandbox import Sandbox
from lqd_llm.sandbox.static_check import CheckedSource, check_source

__all__ = [
    "CheckedSource",
    "CorpusLine",
    "CorpusOutcome",
    "DroppedFunction",
    "InfoKey",
    "InfoLayout",
    "Layer",
    "Limits",
    "RefusedValues",
    "RejectedCodeError",
    "Results",
    "Role",
    "Sandbox",
    "SandboxError",
    "SandboxedFunction",
    "check_source",
    "probe_layers",
    "read_corpus",
    "run_corpus",
]
