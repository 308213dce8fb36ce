"""Inference: from an instruction to the functionals that steer a run."""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import chain, zip_longest
from pathlib import Path

from lqd_envs.perception import PerceptionSchema
from lqd_llm.errors import FunctionError, InferenceError, RecordingError
from lqd_llm.functions import DIRECT_ENTRIES, ENTRIES, InferredFunction, build_function
from lqd_llm.prompts import COUNTS, KINDS, prompt_hash, render_prompt, render_system
from lqd_llm.recordings import Recording, load_recording
from lqd_llm.reply import Reply


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


@dataclass(frozen=True)
class _Built:
    functions: tuple[InferredFunction, ...]
    dropped: tuple[str, ...]


def infer_from_recording(
    task_name: str,
    *,
    instruction: str,
    schema: PerceptionSchema,
    sample: int,
    directory: Path | None = None,
) -> InferredFunctionals:
    """Build the functionals that a recording holds for a task.

    This is the inference of Algorithm 1 with a recorded model. A function that cannot be built is
    dropped and reported, as is one beyond the number that was asked for.

    Args:
        task_name: Short name of the task, such as `"faucet"`.
        instruction: The task in one sentence.
        schema: The task's perception schema.
        sample: Number of the sample; seed k of a benchmark uses sample k.
        directory: Folder of recordings; by default those that ship with the package. The functions
            run in this process without a sandbox, so name only recordings that you trust.

    Raises:
        RecordingError: There is no such recording, it is not of the right form, or it answers
            other prompts than those that `instruction` and `schema` give.
        InferenceError: A kind is left without any function, or `direct` without one of its three.
    """
    recording = load_recording(task_name, sample=sample, directory=directory)
    _check_prompts(recording, instruction=instruction, schema=schema)
    replies = {kind: exchange.reply for kind, exchange in recording.exchanges.items()}
    built = {kind: _build(replies[kind], kind=kind) for kind in ENTRIES}
    direct = _build_direct(replies["direct"])
    return InferredFunctionals(
        success=built["success"].functions[0],
        fitness=built["fitness"].functions,
        timestamps=built["timestamps"].functions,
        quantities=built["quantities"].functions,
        direct=DirectFunctionals(*direct.functions),
        prompt_hashes={
            kind: prompt_hash(recording.system, recording.exchanges[kind].prompt) for kind in KINDS
        },
        model=recording.model,
        provenance=recording.provenance,
        dropped=tuple(chain.from_iterable(part.dropped for part in (*built.values(), direct))),
    )


def _check_prompts(recording: Recording, *, instruction: str, schema: PerceptionSchema) -> None:
    pairs = {"system": (recording.system, render_system(schema))}
    for kind, exchange in recording.exchanges.items():
        pairs[kind] = (exchange.prompt, render_prompt(kind, instruction=instruction))
    for kind, (recorded, rendered) in pairs.items():
        # Unlike splitlines, split("\n") keeps every character that can differ.
        texts = (map(repr, text.split("\n")) for text in (recorded, rendered))
        lines = zip_longest(*texts, fillvalue="missing")
        for number, (there, here) in enumerate(lines, start=1):
            if there != here:
                raise RecordingError(
                    f"Sample {recording.sample} of the task {recording.task!r} answers another "
                    f"{kind} prompt than the task renders: line {number} is {there} in the "
                    f"recording and {here} in the task; restore the task's instruction and "
                    "perception schema, or record the task again."
                )


def _build(reply: Reply, *, kind: str) -> _Built:
    """Build the first functions that can be built, up to the number that was asked for."""
    entry, count = ENTRIES[kind], COUNTS[kind]
    functions: list[InferredFunction] = []
    dropped: list[str] = []
    for source in reply.functions:
        if len(functions) == count:
            dropped.append(
                f"The {kind} function {source.name!r} is not used: {count} came before it, as many "
                "as were asked for."
            )
            continue
        try:
            functions.append(build_function(source, kind=kind, entry=entry))
        except FunctionError as error:
            dropped.append(str(error))
    if not functions:
        raise InferenceError(_nothing_left(f"a {kind} function", reply, dropped=dropped))
    return _Built(functions=tuple(functions), dropped=tuple(dropped))


def _build_direct(reply: Reply) -> _Built:
    """Build the three functions of the kind `direct`, in the order of `DIRECT_ENTRIES`."""
    functions: dict[str, InferredFunction] = {}
    dropped: list[str] = []
    for source in reply.functions:
        if source.name not in DIRECT_ENTRIES:
            dropped.append(
                f"The direct function {source.name!r} is not used: expected the names "
                f"{', '.join(DIRECT_ENTRIES)}."
            )
            continue
        try:
            functions[source.name] = build_function(source, kind="direct", entry=source.name)
        except FunctionError as error:
            dropped.append(str(error))
    for entry in DIRECT_ENTRIES:
        if entry not in functions:
            raise InferenceError(_nothing_left(f"a direct {entry}", reply, dropped=dropped))
    return _Built(
        functions=tuple(functions[entry] for entry in DIRECT_ENTRIES), dropped=tuple(dropped)
    )


def _nothing_left(wanted: str, reply: Reply, *, dropped: list[str]) -> str:
    names = ", ".join(source.name for source in reply.functions) or "an empty reply"
    sentence = f"Expected {wanted} that can be used, got none out of {names}; take another sample."
    return " ".join([sentence, *dropped])
