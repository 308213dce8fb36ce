"""Inference: from an instruction to the functionals that steer a run."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from lqd_envs.perception import PerceptionSchema
from lqd_llm.check import Candidate, CheckFunction, CheckOutcome
from lqd_llm.errors import FunctionError
from lqd_llm.function_choice import candidates_of
from lqd_llm.functions import InferredFunction
from lqd_llm.inferred_functionals import InferredFunctionals
from lqd_llm.inquiry import Inquiry
from lqd_llm.keeping_provider import KeepingProvider
from lqd_llm.model_options import ModelOptions
from lqd_llm.prompts import COUNTS, KINDS, prompt_hash, render_prompt, render_system
from lqd_llm.provider import Provider
from lqd_llm.repair import CheckedFunction, repair
from lqd_llm.reply import FunctionSource, Reply
from lqd_llm.set_remarks import remarks


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
    replacement. Then as many of each as were asked for are checked, all in one call. One that
    fails is repaired up to `MAX_REPAIRS` times and checked again, alone; one that still fails is
    dropped and reported. One beyond the number that was asked for stands in for it if it passes
    as it is; it is not repaired, so that repairs stay few however long a reply is.

    Nothing that the model wrote is run here: that is for `check` to do, in the sandbox.

    Args:
        instruction: The task in one sentence.
        schema: The task's perception schema.
        provider: What answers: a model, or recordings of one.
        check: What decides whether functions can be used, such as that of a `FunctionCheck`. What
            it says of one that fails is told to the model, so nothing of an expert's verdict may be
            in it.
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
    replies = {kind: inquiry.ask(prompts[kind], subject=kind) for kind in KINDS}
    maker = _Maker(_check_all(replies, check), prompts=prompts, check=check, inquiry=inquiry)
    chosen = InferredFunctionals.chosen(
        replies,
        make=maker,
        prompt_hashes={kind: prompt_hash(system, prompts[kind]) for kind in KINDS},
        model=inquiry.model,
        provenance=inquiry.provenance,
        usage=inquiry.usage,
    )
    checked = maker.checked
    return replace(
        chosen,
        repaired=tuple(its.report for its in checked if its.report is not None),
        # Repairs were asked for while the functions were chosen.
        model=inquiry.model,
        provenance=inquiry.provenance,
        usage=inquiry.usage,
        lengths=_lengths(checked),
        remarks=remarks((its.candidate, its.outcome) for its in checked),
    )


class _Maker:
    """Makes the functions that pass their checks, and keeps what the checks found."""

    def __init__(
        self,
        outcomes: Mapping[Candidate, CheckOutcome],
        *,
        prompts: Mapping[str, str],
        check: CheckFunction,
        inquiry: Inquiry,
    ) -> None:
        self.checked: list[CheckedFunction] = []
        self._outcomes = outcomes
        self._prompts = prompts
        self._check = check
        self._inquiry = inquiry

    def __call__(self, source: FunctionSource, kind: str, entry: str) -> InferredFunction:
        candidate = Candidate(source, kind, entry)
        outcome = self._outcomes.get(candidate)
        if outcome is None:
            # It stands in for one that failed, so nobody has looked at it yet.
            (outcome,) = self._check([candidate])
            if outcome.failure is not None:
                raise FunctionError(
                    f"The {kind} function {source.name!r} is not used: it fails its check "
                    f"({outcome.failure}), and only the first {COUNTS[kind]} are repaired."
                )
        checked = repair(
            candidate,
            outcome,
            prompt=self._prompts[kind],
            check=self._check,
            inquiry=self._inquiry,
        )
        self.checked.append(checked)
        return _function(checked.candidate)


def _check_all(replies: Mapping[str, Reply], check: CheckFunction) -> dict[Candidate, CheckOutcome]:
    candidates = [its for kind in KINDS for its in candidates_of(replies[kind], kind=kind)]
    return dict(zip(candidates, check(candidates), strict=True))


def _lengths(checked: Sequence[CheckedFunction]) -> dict[str, int]:
    lengths = {}
    for its in checked:
        candidate, length = its.candidate, its.outcome.length
        if length is not None:
            direct = candidate.kind == "direct"
            lengths["direct.descriptor" if direct else candidate.source.name] = length
    return lengths


def _function(candidate: Candidate) -> InferredFunction:
    source = candidate.source
    return InferredFunction(
        name=source.name,
        description=source.description,
        code=source.code,
        entry=candidate.entry,
    )
