"""How to make what evaluates a run's solutions, here or on another machine."""

import weakref
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace

from lqd_envs import Task, get_task
from lqd_search.cli.llm_extra import llm_extra
from lqd_search.evaluation.expert_judge import ExpertJudge
from lqd_search.evaluation.judge import Judge
from lqd_search.evaluation.motion_evaluator import MotionEvaluator
from lqd_search.evaluation.values import StoppedFunction
from lqd_search.methods.steering import DIRECT, EXPERT
from lqd_search.runs.function_text import DIRECT_KINDS, FunctionText


@dataclass(frozen=True)
class EvaluatorRecipe:
    """How to make the evaluator of a method, here or on another machine.

    It can be pickled and compared, so that a worker makes the evaluator once and keeps it. Where
    inferred functionals steer the method they are called in a sandbox, a process of its own: it
    ends when the evaluator is no longer referred to, and with the process that made it, however
    that ends.

    Attributes:
        task_id: The task.
        steering: What steers the method, one of the values of `STEERING`.
        functions: The functionals that steer it, in order; none steer the expert's.
        lengths: How many numbers each quantity measures, by name, or the direct descriptor.
        threads: Threads to simulate on; 0: one for each CPU.
        allow_weak: Whether the sandbox may lack locks that this system does not have.
        stopped: Functionals that were stopped before, and are not called any more.
    """

    task_id: str
    steering: str
    functions: tuple[FunctionText, ...] = ()
    lengths: tuple[tuple[str, int], ...] = ()
    threads: int = 0
    allow_weak: bool = False
    stopped: tuple[StoppedFunction, ...] = ()

    @classmethod
    def of(
        cls,
        task_id: str,
        *,
        steering: str,
        functions: Sequence[FunctionText],
        lengths: Mapping[str, int],
        threads: int = 0,
        allow_weak: bool = False,
    ) -> "EvaluatorRecipe":
        """Return the recipe of a method, which keeps those of the functionals that steer it.

        Args:
            task_id: The task.
            steering: What steers the method.
            functions: Functionals that passed their checks, of a mesh, direct ones, or both.
            lengths: How many numbers each quantity measures, by name, and the direct descriptor
                under `"direct.descriptor"`.
            threads: As of the recipe.
            allow_weak: As of the recipe.
        """
        chosen = tuple(
            text
            for text in functions
            if steering != EXPERT and (text.kind in DIRECT_KINDS) == (steering == DIRECT)
        )
        known = {text.name for text in chosen} | {text.kind for text in chosen}
        return cls(
            task_id=task_id,
            steering=steering,
            functions=chosen,
            lengths=tuple(sorted((k, length) for k, length in lengths.items() if k in known)),
            threads=threads,
            allow_weak=allow_weak,
        )

    def without(self, stopped: tuple[StoppedFunction, ...]) -> "EvaluatorRecipe":
        """Return the recipe of an evaluator that refuses all values of some functionals.

        Args:
            stopped: These, all of them.
        """
        return replace(self, stopped=stopped)

    def __call__(self) -> MotionEvaluator:
        """Make the evaluator; its sandbox is closed when its judge is no longer referred to.

        Raises:
            LQDError: The functionals cannot be used, or the sandbox does not open.
        """
        with ExitStack() as stack:
            evaluator = self._make(stack)
            weakref.finalize(evaluator.judge, stack.pop_all().close)
        return evaluator

    @contextmanager
    def opened(self) -> Iterator[MotionEvaluator]:
        """Make the evaluator for the length of a `with` block, at whose end its sandbox is closed.

        Raises:
            LQDError: The functionals cannot be used, or the sandbox does not open.
        """
        with ExitStack() as stack:
            yield self._make(stack)

    def _make(self, stack: ExitStack) -> MotionEvaluator:
        task = get_task(self.task_id)
        judge = ExpertJudge(task) if self.steering == EXPERT else self._sandbox_judge(task, stack)
        return MotionEvaluator(task, judge, self.threads)

    def _sandbox_judge(self, task: Task, stack: ExitStack) -> Judge:
        with llm_extra():
            from lqd_search.cli.opened_sandbox import open_sandbox
            from lqd_search.cli.sandbox_judge import SandboxDirectJudge, SandboxMeshJudge
        sandbox = open_sandbox(
            task.schema, self.functions, stopped=self.stopped, allow_weak=self.allow_weak
        )
        if sandbox is not None:
            stack.callback(sandbox.close)
        lengths = dict(self.lengths)
        if self.steering == DIRECT:
            return SandboxDirectJudge(sandbox, lengths=lengths, stopped=self.stopped)
        return SandboxMeshJudge(
            sandbox, functions=self.functions, lengths=lengths, stopped=self.stopped
        )
