"""Spreading the evaluation of solutions over a Dask cluster."""

import pickle
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import NDArray

from lqd_search.evaluation.cluster import ClusterError, check_installation, import_distributed
from lqd_search.evaluation.concatenation import concatenate_values
from lqd_search.evaluation.installation import installation
from lqd_search.evaluation.values import Values
from lqd_search.evaluation.worker_pool import WorkerPool

if TYPE_CHECKING:
    from distributed import Client

    # Its module imports the methods, which take seconds to load and which no worker needs.
    from lqd_search.loop import Evaluate

EvaluatorRecipe = Callable[[], "Evaluate"]
"""Builds an evaluator where it is needed, and can be pickled."""


class ClusterEvaluator:
    """Evaluates solutions on the workers of a cluster.

    The values are, bit for bit, those that the recipe's evaluator gives here, at any number of
    workers and in chunks of any size, as long as each row of an evaluator's values depends on its
    own solution alone and the workers have this machine's kind of processor. A worker builds its
    evaluator once and keeps it; what travels back are values only. Each chunk says what is
    installed here, and a worker that has other versions or sources evaluates none, whenever it
    joined.

    A chunk whose worker died is evaluated again by another one. Where no chunk has come back for
    `patience` seconds, the workers that are evaluating one are taken to hang: those that have a
    nanny are restarted, the others get no chunk anymore, and their chunks are evaluated again.

    Args:
        client: The connection to the cluster, as `open_cluster` gives it.
        recipe: Builds the evaluator on a worker.
        chunk: Solutions in one piece of work.
        patience: Seconds; more than a chunk takes, and than a worker takes to build its evaluator.
        retries: How often a chunk may lose its worker, and how often it may hang, before the batch
            is given up.
    """

    def __init__(
        self,
        client: "Client",
        recipe: EvaluatorRecipe,
        *,
        chunk: int = 64,
        patience: float = 300.0,
        retries: int = 3,
    ) -> None:
        if chunk < 1:
            raise ClusterError(
                f"Expected chunks of at least one solution, but got {chunk}; raise it."
            )
        self._cluster = WorkerPool(client, patience=patience)
        self._recipe = _pickled(recipe)
        self._chunk = chunk
        self._retries = retries

    def __call__(self, solutions: NDArray[np.float64]) -> Values:
        """Evaluate (N, dim) solutions.

        An error that the evaluation itself raises on a worker is raised here as it is.

        Raises:
            ClusterError: The scheduler or all workers are gone, a chunk lost its worker or hung
                more than `retries` times, or a worker has other versions or sources than are
                installed here.
        """
        starts = range(0, max(len(solutions), 1), self._chunk)
        chunks = [_Chunk(start, solutions[start : start + self._chunk]) for start in starts]
        batch = _Batch(self._cluster, self._recipe, chunks, retries=self._retries)
        return concatenate_values(batch.evaluate())


def evaluate_chunk(
    recipe: bytes, solutions: NDArray[np.float64], expected: Mapping[str, str]
) -> Values:
    """Evaluate a chunk on the worker that this runs on.

    Args:
        recipe: The pickled recipe, whose evaluator is built unless this process has it already.
        solutions: (n, dim) solutions.
        expected: What is installed where the values are used.

    Raises:
        ClusterError: Something else is installed here.
    """
    check_installation(_this_worker(), installation(), expected=expected)
    # What comes over the network is read-only, and an evaluator need not expect that.
    values = _evaluator(recipe)(np.array(solutions))
    if values.stopped:
        # It refuses from now on what it stopped here, and the next chunk, of this batch or of
        # another run, must not depend on that.
        _evaluator.cache_clear()
    return values


def _this_worker() -> str:
    return cast(str, import_distributed().get_worker().address)


@lru_cache(maxsize=4)
def _evaluator(recipe: bytes) -> "Evaluate":
    build: EvaluatorRecipe = pickle.loads(recipe)
    return build()


def _pickled(recipe: EvaluatorRecipe) -> bytes:
    # A worker that cannot unpickle a message leaves the cluster. Unpickled as a part of the
    # evaluation, a recipe that is not understood there is an error like any other.
    import_distributed()
    import cloudpickle  # type: ignore[import-untyped]

    return cast(bytes, cloudpickle.dumps(recipe))


@dataclass(eq=False)
class _Chunk:
    start: int
    solutions: NDArray[np.float64]
    deaths: int = 0
    hangs: int = 0

    @property
    def name(self) -> str:
        return f"solutions {self.start} to {self.start + len(self.solutions) - 1} of the batch"


class _Batch:
    """The chunks of one batch, each of them waiting, in flight, or back as a part."""

    def __init__(
        self, cluster: WorkerPool, recipe: bytes, chunks: list[_Chunk], *, retries: int
    ) -> None:
        self._cluster = cluster
        self._recipe = recipe
        self._retries = retries
        self._waiting = deque(chunks)
        self._flying: dict[Any, _Chunk] = {}
        self._parts: dict[int, Values] = {}

    def evaluate(self) -> list[Values]:
        try:
            while self._waiting or self._flying:
                self._take_off()
                done = self._cluster.wait(list(self._flying))
                for future in done:
                    self._land(future)
                if not done:
                    self._end_hang()
        finally:
            # Released futures are forgotten by the scheduler, which spares the workers the rest.
            for future in self._flying:
                future.release()
        return [self._parts[start] for start in sorted(self._parts)]

    def _take_off(self) -> None:
        # No more chunks than threads: those behind another one on the same worker would share the
        # blame when it dies or hangs.
        workers = self._cluster.workers() if self._waiting else []
        while self._waiting and len(self._flying) < max(1, len(workers)):
            chunk = self._waiting[0]
            future = self._cluster.submit(
                evaluate_chunk,
                self._recipe,
                chunk.solutions,
                installation(),
                workers=workers,
            )
            self._flying[future] = self._waiting.popleft()

    def _land(self, future: Any) -> None:
        deaths, part = self._cluster.fetch(future)
        if part is not None:
            self._parts[self._flying.pop(future).start] = part
            future.release()
        elif deaths:
            chunk = self._take_back(future)
            chunk.deaths += deaths
            if chunk.deaths > self._retries:
                raise ClusterError(
                    f"Expected values for {chunk.name}, but they lost their worker "
                    f"{chunk.deaths} times; see the workers' logs for what killed them, then "
                    "resume the run."
                )

    def _end_hang(self) -> None:
        placed = self._cluster.placed(self._flying)
        for future in placed:
            chunk = self._take_back(future)
            chunk.hangs += 1
            if chunk.hangs > self._retries:
                raise ClusterError(
                    f"Expected values for {chunk.name}, but {chunk.hangs} times nothing came back "
                    f"for {self._cluster.patience:g} seconds; see the workers' logs for where they "
                    "hang, then resume the run."
                )
        if placed:
            self._cluster.free(set(placed.values()))
        else:
            self._cluster.require_workers()
            # They may wait for a worker that has left.
            for future in list(self._flying) if self._cluster.avoids_workers else ():
                self._take_back(future)

    def _take_back(self, future: Any) -> _Chunk:
        chunk = self._flying.pop(future)
        future.release()
        self._waiting.appendleft(chunk)
        return chunk
