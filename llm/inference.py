"""Inference: from an instruction to the functionals that steer a run."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import chain, zip_longest
from pathlib import Path
from typing import Any

from lqd_envs.perception import PerceptionSchema
from lqd_llm.errors import FunctionError, RecordingError
from lqd_llm.function_choice import FunctionChoice, choose_direct, choose_functions
from lqd_llm.functions import ENTRIES, FunctionCall, InferredFunction, build_function
from lqd_llm.inquiry import Inquiry
from lqd_llm.keeping_provider import KeepingProvider
from lqd_llm.model_options import ModelOptions
from lqd_llm.prompts import KINDS, prompt_hash, render_prompt, render_system
from lqd_llm.provider import Provider
from lqd_llm.recordings import Recording, load_recording
from lqd_llm.repair import CheckFunction, check_and_repair
from lqd_llm.reply import FunctionSource
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


def infer(
    *,
    instruction: str,
    schema: PerceptionSchema,
    provider: Provider,
    check: CheckFunction,
    options: ModelOptions | None = None,
    sample: int = 0,
    transcript: Path | None = None,
) -> InferredFunctionals:
    """Ask for all functionals of a task, check them, and have repaired those that fail.

    Each kind is asked in one request, since it is within a reply that functions are sampled without
    replacement. A function that fails its check is repaired up to `MAX_REPAIRS` times; one that
    still fails is dropped and reported, as is one beyond the number that was asked for.

    Nothing that the model wrote is run here, whatever `check` does: the functions of the result
    have their code, and `call` of them raises `FunctionError`.

    Args:
        instruction: The task in one sentence.
        schema: The task's perception schema.
        provider: What answers: a model, or recordings of one.
        check: What decides whether a function can be used. What it says of one that fails is told
            to the model, so nothing of an expert's verdict may be in it.
        options: Which model is asked, and how; by default `ModelOptions()`.
        sample: Which of several inferences of the same task is wanted.
        transcript: Folder in which everything sent and received is kept, each answer as soon as it
            comes; answers that are there already are used and not asked for again.

    Raises:
        ProviderError: The model could not be asked, or gave no answer.
        ReplyError: An answer holds no functions.
        InferenceError: A kind is left without any function, or `direct` without one of its three.
        RecordingError: Recordings answer, and they have none of a request; or an answer cannot be
            read from the transcript or written to it.
    """
    system = render_system(schema)
    prompts = {kind: render_prompt(kind, instruction=instruction) for kind in KINDS}
    inquiry = Inquiry(
        provider if transcript is None else KeepingProvider(provider, folder=transcript),
        options=ModelOptions() if options is None else options,
        system=system,
        sample=sample,
    )
    repaired: list[str] = []

    def make(source: FunctionSource, kind: str, entry: str) -> InferredFunction:
        prompt = prompts[kind]
        checked = check_and_repair(
            source, kind=kind, entry=entry, prompt=prompt, check=check, inquiry=inquiry
        )
        if checked.report is not None:
            repaired.append(checked.report)
        return _unrun(checked.source, entry=entry)

    chosen: dict[str, FunctionChoice] = {}
    for kind in KINDS:
        reply = inquiry.ask(prompts[kind], subject=kind)
        chosen[kind] = (
            choose_direct(reply, make=make)
            if kind == "direct"
            else choose_functions(reply, kind=kind, make=make)
        )
    return _functionals(
        chosen,
        prompt_hashes={kind: prompt_hash(system, prompts[kind]) for kind in KINDS},
        model=inquiry.model,
        provenance=inquiry.provenance,
        repaired=tuple(repaired),
        usage=inquiry.usage,
    )


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
    chosen = {kind: choose_functions(replies[kind], kind=kind, make=_build) for kind in ENTRIES}
    chosen["direct"] = choose_direct(replies["direct"], make=_build)
    return _functionals(
        chosen,
        prompt_hashes={
            kind: prompt_hash(recording.system, recording.exchanges[kind].prompt) for kind in KINDS
        },
        model=recording.model,
        provenance=recording.provenance,
        usage=Usage(requests=len(KINDS), unreported=len(KINDS)),
    )


def _functionals(
    chosen: Mapping[str, FunctionChoice],
    *,
    prompt_hashes: Mapping[str, str],
    model: str,
    provenance: str,
    usage: Usage,
    repaired: tuple[str, ...] = (),
) -> InferredFunctionals:
    return InferredFunctionals(
        success=chosen["success"].functions[0],
        fitness=chosen["fitness"].functions,
        timestamps=chosen["timestamps"].functions,
        quantities=chosen["quantities"].functions,
        direct=DirectFunctionals(*chosen["direct"].functions),
        prompt_hashes=prompt_hashes,
        model=model,
        provenance=provenance,
        dropped=tuple(chain.from_iterable(chosen[kind].dropped for kind in KINDS)),
        repaired=repaired,
        usage=usage,
    )


def _build(source: FunctionSource, kind: str, entry: str) -> InferredFunction:
    return build_function(source, kind=kind, entry=entry)


def _unrun(source: FunctionSource, *, entry: str) -> InferredFunction:
    return InferredFunction(
        name=source.name,
        description=source.description,
        code=source.code,
        entry=entry,
        call=_refusing(source.name),
    )


def _refusing(name: str) -> FunctionCall:
    def call(_: Any) -> Any:
        raise FunctionError(
            f"Expected the function {name!r} to run in the sandbox, but it was called in this "
            "process; hand its code to the sandbox."
        )

    return call


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
