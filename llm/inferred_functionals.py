"""What inference gives: all functionals of one task."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import chain

from lqd_llm.function_choice import FunctionChoice, MakeFunction, choose_direct, choose_functions
from lqd_llm.functions import InferredFunction
from lqd_llm.prompts import KINDS
from lqd_llm.reply import Reply
from lqd_llm.usage import Usage


@dataclass(frozen=True)
class DirectFunctionals:
    """What a model writes when it is asked for everything at once: the paper's ablation.

    Attributes:
        success: `infos -> bool`.
        fitness: `info -> float`.
        descriptor: `infos -> tuple of 2 to 5 floats, or None` where it is not defined.
    """

    success: InferredFunction
    fitness: InferredFunction
    descriptor: InferredFunction


@dataclass(frozen=True)
class InferredFunctionals:
    """All functionals of one task, and where they come from.

    Attributes:
        success: `infos -> bool`.
        fitness: The candidates, `info -> float`; 3 unless some were dropped.
        timestamps: The moments h, `infos -> info or None`; 4 unless some were dropped.
        quantities: The quantities g, `info -> tuple of 2 to 5 floats`; 4 unless some were dropped.
        direct: The functions of the ablation that asks for everything at once.
        prompt_hashes: For each of `lqd_llm.KINDS`, the hash of the prompts that were answered.
        model: The model, as far as it is known.
        provenance: How the replies were taken.
        dropped: One sentence for each function of a reply that is not used.
        repaired: One sentence for each function that the model had to repair.
        usage: What the answers took when they were given, repairs included.
        lengths: How many numbers each quantity gives, by name, and under `"direct.descriptor"` the
            direct descriptor; only of functions that were checked.
        remarks: One sentence for each function that was checked, can be used, and adds little.
    """

    success: InferredFunction
    fitness: tuple[InferredFunction, ...]
    timestamps: tuple[InferredFunction, ...]
    quantities: tuple[InferredFunction, ...]
    direct: DirectFunctionals
    prompt_hashes: Mapping[str, str]
    model: str
    provenance: str
    dropped: tuple[str, ...]
    repaired: tuple[str, ...] = ()
    usage: Usage = field(default_factory=Usage)
    lengths: Mapping[str, int] = field(default_factory=dict)
    remarks: tuple[str, ...] = ()

    @classmethod
    def chosen(
        cls,
        replies: Mapping[str, Reply],
        *,
        make: MakeFunction,
        prompt_hashes: Mapping[str, str],
        model: str,
        provenance: str,
        usage: Usage,
    ) -> "InferredFunctionals":
        """Choose from replies the functions that can be used.

        Args:
            replies: The reply to each of `lqd_llm.KINDS`.
            make: Makes a function, or raises `FunctionError` where it cannot be used.
            prompt_hashes: As the attributes.
            model: As the attributes.
            provenance: As the attributes.
            usage: As the attributes.

        Raises:
            InferenceError: A kind is left without any function, or `direct` without one of its
                three.
        """
        chosen = {kind: _choose(replies[kind], kind=kind, make=make) for kind in KINDS}
        return cls(
            success=chosen["success"].functions[0],
            fitness=chosen["fitness"].functions,
            timestamps=chosen["timestamps"].functions,
            quantities=chosen["quantities"].functions,
            direct=DirectFunctionals(*chosen["direct"].functions),
            prompt_hashes=prompt_hashes,
            model=model,
            provenance=provenance,
            dropped=tuple(chain.from_iterable(chosen[kind].dropped for kind in KINDS)),
            usage=usage,
        )


def _choose(reply: Reply, *, kind: str, make: MakeFunction) -> FunctionChoice:
    if kind == "direct":
        return choose_direct(reply, make=make)
    return choose_functions(reply, kind=kind, make=make)
