"""Judging by functionals that run in the sandbox.

The values are, bit for bit, those of `MeshJudge` and `DirectJudge`, which call the functionals in
this process.
"""

from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from lqd_envs import Trajectories
from lqd_llm.sandbox import Results, Role, Sandbox
from lqd_search.evaluation.direct_judge import DIRECT
from lqd_search.evaluation.functionals import FunctionalError
from lqd_search.evaluation.values import Refusal, StoppedFunction, Values
from lqd_search.runs.function_text import FunctionText

DIRECT_DESCRIPTOR = "direct.descriptor"
"""In place of a quantity's name: the descriptor that a model writes with everything else."""

_NO_RESULTS = Results({}, {}, {}, {}, {}, {}, {}, (), ())


class SandboxMeshJudge:
    """Judges motions by one success, several fitness functions and the descriptors of a BD mesh.

    It implements `Judge`. A functional that the sandbox stops is refused from that motion on, and
    is among the values' `stopped`.

    Args:
        sandbox: It is open, as `open_sandbox` gives it for the same functions.
        functions: The functionals of the mesh, in order.
        lengths: How many numbers each quantity measures, by name.
        stopped: Those that the sandbox does not call: all of their values are refused.

    Attributes:
        fitness_names: The fitness functions, in order.
        descriptors: For each descriptor of the mesh, in order, its number of measures.
        dropped: Empty.

    Raises:
        FunctionalError: A quantity has no length.
    """

    def __init__(
        self,
        sandbox: Sandbox | None,
        *,
        functions: Sequence[FunctionText],
        lengths: Mapping[str, int],
        stopped: Iterable[StoppedFunction] = (),
    ) -> None:
        names = {role: [f.name for f in functions if f.kind == role] for role in Role}
        self._calls = _SandboxCalls(
            sandbox,
            lengths={(Role.QUANTITY, g): _length(lengths, g) for g in names[Role.QUANTITY]},
            stopped=stopped,
        )
        self._pairs = {
            f"{h}.{g}": (h, g) for h in names[Role.TIMESTAMP] for g in names[Role.QUANTITY]
        }
        self.fitness_names = tuple(names[Role.FITNESS])
        self.descriptors = {name: lengths[g] for name, (_, g) in self._pairs.items()}
        self.dropped: tuple[str, ...] = ()

    def __call__(self, trajectories: Trajectories) -> Values:
        """Judge N motions.

        Raises:
            SandboxError: The sandbox is closed, or its worker cannot go on.
        """
        results, rows, n = self._calls(trajectories), *_rows(trajectories)
        success = np.zeros(n, bool)
        success[rows] = results.success.get("success", False)
        return Values(
            valid=trajectories.valid,
            success=success,
            fitness={
                name: _spread(results.fitness.get(name), rows, shape=(n,))
                for name in self.fitness_names
            },
            measures={
                name: _spread(results.quantities.get(self._pairs[name]), rows, shape=(n, length))
                for name, length in self.descriptors.items()
            },
            refusals=self._calls.refusals(results, rows),
            stopped=self._calls.newly_stopped(),
        )


class SandboxDirectJudge:
    """Judges motions by one success, one fitness and one descriptor.

    It implements `Judge`. A functional that the sandbox stops is refused from that motion on, and
    is among the values' `stopped`.

    Args:
        sandbox: It is open, as `open_sandbox` gives it for the three functions.
        lengths: How many numbers the descriptor measures, under `"direct.descriptor"`.
        stopped: Those that the sandbox does not call: all of their values are refused.

    Attributes:
        fitness_names: `("direct",)`.
        descriptors: `direct` with its number of measures.
        dropped: Empty.

    Raises:
        FunctionalError: The descriptor has no length.
    """

    def __init__(
        self,
        sandbox: Sandbox | None,
        *,
        lengths: Mapping[str, int],
        stopped: Iterable[StoppedFunction] = (),
    ) -> None:
        length = _length(lengths, DIRECT_DESCRIPTOR)
        self._calls = _SandboxCalls(
            sandbox, lengths={(Role.DESCRIPTOR, DIRECT): length}, stopped=stopped
        )
        self.fitness_names: tuple[str, ...] = (DIRECT,)
        self.descriptors = {DIRECT: length}
        self.dropped: tuple[str, ...] = ()

    def __call__(self, trajectories: Trajectories) -> Values:
        """Judge N motions.

        Raises:
            SandboxError: The sandbox is closed, or its worker cannot go on.
        """
        results, rows, n = self._calls(trajectories), *_rows(trajectories)
        success = np.zeros(n, bool)
        success[rows] = results.success.get(DIRECT, False)
        shape = (n, self.descriptors[DIRECT])
        return Values(
            valid=trajectories.valid,
            success=success,
            fitness={DIRECT: _spread(results.fitness.get(DIRECT), rows, shape=(n,))},
            measures={DIRECT: _spread(results.descriptors.get(DIRECT), rows, shape=shape)},
            refusals=self._calls.refusals(results, rows),
            stopped=self._calls.newly_stopped(),
        )


class _SandboxCalls:
    def __init__(
        self,
        sandbox: Sandbox | None,
        *,
        lengths: Mapping[tuple[Role, str], int],
        stopped: Iterable[StoppedFunction],
    ) -> None:
        self._sandbox = sandbox
        self._lengths = lengths
        self._stopped = tuple(stopped)

    def __call__(self, trajectories: Trajectories) -> Results:
        if self._sandbox is None:
            return _NO_RESULTS
        rows, _ = _rows(trajectories)
        return self._sandbox.run(trajectories.columns.rows(rows).arrays(), lengths=self._lengths)

    def refusals(self, results: Results, rows: NDArray[np.intp]) -> tuple[Refusal, ...]:
        """Return what was refused, with motions as indices in the whole batch."""
        called = [(r.name, str(r.role), r.reason, r.motions) for r in results.refusals]
        defined = np.zeros(len(rows), bool)
        for moments in results.moments.values():
            defined |= moments >= 0
        for stopped in self._stopped:
            asked = defined if stopped.kind == Role.QUANTITY else np.ones(len(rows), bool)
            motions = np.flatnonzero(asked)
            if len(motions):
                called.append((stopped.functional, stopped.kind, stopped.reason, motions))
        refusals = [
            Refusal(name, kind, len(motions), reason, int(rows[motions[0]]))
            for name, kind, reason, motions in called
        ]
        return tuple(sorted(refusals, key=lambda refusal: refusal.first_motion))

    def newly_stopped(self) -> tuple[StoppedFunction, ...]:
        # All since it was opened, and not those of one batch: a function that was stopped in one is
        # refused in the whole of the next.
        dropped = self._sandbox.dropped if self._sandbox else ()
        return tuple(StoppedFunction(d.name, str(d.role), d.reason) for d in dropped)


def _rows(trajectories: Trajectories) -> tuple[NDArray[np.intp], int]:
    return np.flatnonzero(trajectories.valid), len(trajectories)


def _spread(
    column: NDArray[np.float64] | None, rows: NDArray[np.intp], *, shape: tuple[int, ...]
) -> NDArray[np.float64]:
    """Return a column of the whole batch, NaN but for some rows; numbers beyond it are cut off."""
    spread = np.full(shape, np.nan)
    if column is not None:
        spread[rows] = column[:, : shape[1]] if len(shape) > 1 else column
    return spread


def _length(lengths: Mapping[str, int], name: str) -> int:
    if name not in lengths:
        raise FunctionalError(
            f"Expected to know how many numbers {name!r} measures, but there is a length only for "
            f"{', '.join(map(repr, lengths)) or 'none'}; check the functionals on example motions."
        )
    return lengths[name]
