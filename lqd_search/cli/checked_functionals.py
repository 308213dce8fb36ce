"""Functionals that passed their checks, inferred or from a folder."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from lqd_envs import LQDError, Task, rollout
from lqd_envs.tasks.examples import example_solutions
from lqd_search.cli.llm_extra import llm_extra
from lqd_search.cli.llm_options import LLMOptions
from lqd_search.runs.function_text import DIRECT_KINDS, FUNCTION_KINDS, FunctionText

if TYPE_CHECKING:
    from lqd_llm import Candidate, CheckOutcome, FunctionCheck, InferredFunctionals, Usage

_MESH_KINDS = tuple(kind for kind in FUNCTION_KINDS if kind not in DIRECT_KINDS)
_FROM_A_FOLDER = "Functionals from a folder of files, which a person may have written or changed."
_PROMPTS = {"timestamp": "timestamps", "quantity": "quantities"}


@dataclass(frozen=True)
class CheckedFunctionals:
    """Functionals that passed their checks.

    Attributes:
        texts: All that can be used, in order: those of the mesh, then those that steer directly.
        lengths: How many numbers each quantity gives, by name; those of the direct descriptor under
            `"direct.descriptor"`.
        remarks: One sentence for each that adds little.
        dropped: One sentence for each that is not used.
        repaired: One sentence for each that the model had to repair.
        usage: What the model's answers took; None: no model was asked.
        prompt_hashes: For each kind of prompt, the hash of the prompts that were answered.
        model: The model, as far as it is known.
        provenance: Where they come from.
    """

    texts: tuple[FunctionText, ...]
    lengths: Mapping[str, int]
    remarks: tuple[str, ...] = ()
    dropped: tuple[str, ...] = ()
    repaired: tuple[str, ...] = ()
    usage: "Usage | None" = None
    prompt_hashes: Mapping[str, str] = field(default_factory=dict)
    model: str = "unknown"
    provenance: str = _FROM_A_FOLDER


def infer_functionals(
    task: Task,
    *,
    llm: LLMOptions,
    instruction: str,
    sample: int,
    threads: int,
    allow_weak: bool,
    transcript: Path | None,
) -> CheckedFunctionals:
    """Ask a model or its recordings for functionals, and check them in the sandbox.

    Args:
        task: The task.
        llm: What answers.
        instruction: The task in one sentence.
        sample: Which of several inferences.
        threads: Threads to simulate example motions on; 0: one for each CPU.
        allow_weak: Whether code that does not ship with the package may run in a sandbox that lacks
            a layer.
        transcript: Folder in which everything sent and received is kept, and from which an
            inference that was interrupted goes on.

    Raises:
        LQDError: The extra `llm` is not installed, the model could not be asked, its answers cannot
            be used, or the sandbox does not start.
    """
    with llm_extra():
        from lqd_llm import ExchangeFolder, infer
    _require_text(instruction)
    options = llm.model_options()
    with llm.provider(transcript=transcript) as provider:
        check = _function_check(task, threads=threads, allow_weak=allow_weak)
        if llm.asks_a_model:
            check.require_sandbox()
        inferred = infer(
            instruction=instruction,
            schema=task.schema,
            provider=provider,
            check=check.check,
            options=options,
            sample=sample,
        )
    return CheckedFunctionals(
        texts=tuple(_texts(inferred)),
        lengths=inferred.lengths,
        remarks=inferred.remarks,
        dropped=inferred.dropped,
        repaired=inferred.repaired,
        # Answers that could not be used were paid for too.
        usage=ExchangeFolder(transcript).usage() if transcript else inferred.usage,
        prompt_hashes=inferred.prompt_hashes,
        model=inferred.model,
        provenance=inferred.provenance,
    )


def check_functionals(
    task: Task, texts: Sequence[FunctionText], *, threads: int, allow_weak: bool
) -> CheckedFunctionals:
    """Check functionals that are there already, such as those of a folder, in the sandbox.

    Args:
        task: The task.
        texts: The functionals.
        threads: Threads to simulate example motions on; 0: one for each CPU.
        allow_weak: Whether code that does not ship with the package may run in a sandbox that lacks
            a layer.

    Raises:
        LQDError: The extra `llm` is not installed, there are not enough functionals for a method,
            one fails its check, or the sandbox does not start.
    """
    _require_enough(texts)
    candidates = [_candidate(text) for text in texts]
    check = _function_check(task, threads=threads, allow_weak=allow_weak)
    outcomes = check.check(candidates)
    _require_passed(texts, outcomes)
    with llm_extra():
        from lqd_llm import remarks
    return CheckedFunctionals(
        texts=tuple(texts),
        lengths={
            text.kind if text.kind in DIRECT_KINDS else text.name: outcome.length
            for text, outcome in zip(texts, outcomes, strict=True)
            if outcome.length is not None
        },
        remarks=remarks(zip(candidates, outcomes, strict=True)),
    )


def _require_text(instruction: str) -> None:
    if not instruction.strip():
        raise LQDError("Expected an instruction of at least one word, but it is empty; say it.")
    try:
        instruction.encode()
    except UnicodeEncodeError as error:
        raise LQDError(
            "Expected an instruction in UTF-8, but its character "
            f"{error.start + 1} is {instruction[error.start]!a}; type it anew."
        ) from error


def _function_check(task: Task, *, threads: int, allow_weak: bool) -> "FunctionCheck":
    with llm_extra():
        from lqd_llm import FunctionCheck, perception_layout
    trajectories = rollout(task, example_solutions(task), threads=threads)
    columns = trajectories.columns.rows(np.flatnonzero(trajectories.valid))
    return FunctionCheck(perception_layout(task.schema), columns.arrays(), allow_weak=allow_weak)


def _texts(inferred: "InferredFunctionals") -> Iterator[FunctionText]:
    direct = inferred.direct
    functions = {
        "success": (inferred.success,),
        "fitness": inferred.fitness,
        "timestamp": inferred.timestamps,
        "quantity": inferred.quantities,
        "direct.success": (direct.success,),
        "direct.fitness": (direct.fitness,),
        "direct.descriptor": (direct.descriptor,),
    }
    for kind in FUNCTION_KINDS:
        for function in functions[kind]:
            named = kind in ("fitness", "timestamp", "quantity")
            name = function.name if named else function.entry
            yield FunctionText(kind, name, function.description, function.code)


def _candidate(text: FunctionText) -> "Candidate":
    with llm_extra():
        from lqd_llm import Candidate, FunctionSource
    # Not validated: a name in a file may be another than a model's is made to be.
    source = FunctionSource.model_construct(
        name=text.name, description=text.description, code=text.code
    )
    kind = "direct" if text.kind in DIRECT_KINDS else _PROMPTS.get(text.kind, text.kind)
    return Candidate(source, kind, text.entry)


def _require_enough(texts: Sequence[FunctionText]) -> None:
    there = {text.kind for text in texts}
    missing = [
        [kind for kind in kinds if kind not in there] for kinds in (_MESH_KINDS, DIRECT_KINDS)
    ]
    if not all(missing):
        return
    mesh, direct = (", ".join(kinds) for kinds in missing)
    raise LQDError(
        "Expected functionals of every kind that a mesh needs, or all three direct ones, but there "
        f"is no {mesh}, and no {direct}; add the missing files."
    )


def _require_passed(texts: Sequence[FunctionText], outcomes: "Sequence[CheckOutcome]") -> None:
    failures = []
    for text, outcome in zip(texts, outcomes, strict=True):
        if (failure := outcome.failure) is not None:
            # The first line of its file is the description.
            line = None if failure.line is None else failure.line + 1
            failures.append(f"{text.file_name} fails ({replace(failure, line=line)})")
    if failures:
        raise LQDError(
            f"Expected functionals that pass their checks, but {', and '.join(failures)}; correct "
            f"{'the file, or leave it' if len(failures) == 1 else 'the files, or leave them'} out."
        )
