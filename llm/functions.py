"""Functions that a model wrote, as text; they run in `lqd_llm.sandbox` and nowhere else."""

from dataclasses import dataclass

ENTRIES = {
    "success": "success",
    "fitness": "fitness",
    "timestamps": "timestamp",
    "quantities": "quantity",
}
"""What the functions of a kind are called in their code, whatever their own names."""

DIRECT_ENTRIES = ("success", "fitness", "descriptor")
"""The three functions of the kind `direct`, which are called the same as they are named."""


@dataclass(frozen=True)
class InferredFunction:
    """One function that a model wrote. It cannot be called: its code is for the sandbox.

    Attributes:
        name: Its name, an identifier, distinct from the others of the same reply.
        description: What it measures, in the model's words.
        code: Its source, exactly as the model wrote it.
        entry: Name of the function in `code` that is called.
    """

    name: str
    description: str
    code: str
    entry: str
