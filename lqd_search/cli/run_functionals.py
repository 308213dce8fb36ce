"""What steers a new run: the expert, or functionals that passed their checks."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

from lqd_envs import LQDError, Task
from lqd_search.cli.checked_functionals import (
    CheckedFunctionals,
    check_functionals,
    infer_functionals,
)
from lqd_search.cli.kept_inference import KeptInference, keep_inference
from lqd_search.cli.llm_options import LLMOptions
from lqd_search.methods.steering import DIRECT, EXPERT, STEERING
from lqd_search.runs.function_text import DIRECT_KINDS
from lqd_search.runs.functionals_folder import read_functionals, read_origin
from lqd_search.runs.functionals_index import Origin
from lqd_search.runs.run_config import NO_MODEL

FOLDER = "folder"
"""In place of what answered the prompts: a folder that the user named."""

_EXPERT = CheckedFunctionals(
    texts=(), lengths={}, model="none", provenance="The expert steers; no model was asked."
)


@dataclass(frozen=True)
class RunFunctionals:
    """What steers a new run.

    Attributes:
        llm: Where it comes from: what answered the prompts, `FOLDER` or `NO_MODEL`.
        instruction: The sentence that the functionals were inferred for.
        checked: The functionals, which passed their checks; none where the expert steers.
        kept: What was sent and received, for the run's folder; None where nothing was.
    """

    llm: str
    instruction: str
    checked: CheckedFunctionals
    kept: KeptInference | None = None

    @property
    def origin(self) -> Origin:
        """Where they come from, as it is kept beside them."""
        checked = self.checked
        return Origin(
            self.instruction, checked.model, checked.provenance, dict(checked.prompt_hashes)
        )


@dataclass(frozen=True)
class FunctionalsSource:
    """Where the functionals of a new run are to come from.

    Attributes:
        llm: What answers the prompts.
        instruction: What to do, in one sentence; None: the task's own instruction.
        sample: Which of several inferences.
        directory: A folder of functionals that is used instead; None: there is none.
    """

    llm: LLMOptions
    instruction: str | None = None
    sample: int = 0
    directory: Path | None = None

    @contextmanager
    def get(
        self, task: Task, *, method: str, output: Path, threads: int, allow_weak: bool
    ) -> Iterator[RunFunctionals]:
        """Infer or read the functionals, and check them.

        What a model answered is kept beside the output until it is moved into it; where that does
        not come about, it is used at the next try.

        Args:
            task: The task.
            method: Name of the method.
            output: The run's folder, which is made within this.
            threads: Threads to simulate example motions on; 0: one for each CPU.
            allow_weak: Whether code that does not ship with the package may run in a sandbox that
                lacks a layer.

        Raises:
            LQDError: They cannot be had, or cannot be used for the method.
        """
        instruction = task.instruction if self.instruction is None else self.instruction
        if STEERING[method] == EXPERT:
            self._refuse_for_expert(method)
            yield RunFunctionals(NO_MODEL, task.instruction, _EXPERT)
        elif self.directory is not None:
            yield _from_folder(
                self.directory, task, method=method, threads=threads, allow_weak=allow_weak
            )
        else:
            with keep_inference(
                output, task, llm=self.llm, instruction=instruction, sample=self.sample
            ) as kept:
                checked = infer_functionals(
                    task,
                    llm=self.llm,
                    instruction=instruction,
                    sample=self.sample,
                    threads=threads,
                    allow_weak=allow_weak,
                    transcript=kept.path,
                )
                yield RunFunctionals(self.llm.mode, instruction, checked, kept)

    def _refuse_for_expert(self, method: str) -> None:
        if self.directory is not None or self.instruction is not None or self.llm != LLMOptions():
            raise LQDError(
                f"Expected neither functionals nor a model to ask with the method {method!r}, "
                "which the expert steers, but got one of them; leave it out, or choose another "
                "method."
            )


def _from_folder(
    directory: Path, task: Task, *, method: str, threads: int, allow_weak: bool
) -> RunFunctionals:
    texts, origin = read_functionals(directory), read_origin(directory)
    _require_kinds({text.kind for text in texts}, directory=directory, method=method)
    checked = check_functionals(task, texts, threads=threads, allow_weak=allow_weak)
    if origin is None:
        return RunFunctionals(FOLDER, task.instruction, checked)
    provenance = f"{checked.provenance} Before that: {origin.provenance}"
    return RunFunctionals(
        FOLDER,
        origin.instruction,
        replace(
            checked,
            prompt_hashes=origin.prompt_hashes,
            model=origin.model,
            provenance=provenance,
        ),
    )


def _require_kinds(there: set[str], *, directory: Path, method: str) -> None:
    wanted = (
        DIRECT_KINDS
        if STEERING[method] == DIRECT
        else ("success", "fitness", "timestamp", "quantity")
    )
    missing = [kind for kind in wanted if kind not in there]
    if missing:
        raise LQDError(
            f"Expected functionals in {directory} that can steer the method {method!r}, but there "
            f"is no {', '.join(missing)}; add the missing files, or choose another method."
        )
