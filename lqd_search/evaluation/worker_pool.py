"""The workers of a Dask cluster: which there are, what they do, and ending those that hang."""

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from typing import Any

from lqd_search.evaluation.cluster import ClusterError, import_distributed

_RESTART_SECONDS = 60
_LOST = (
    "Expected the Dask scheduler to see the evaluation through, but the connection to it is lost; "
    "see that it is running, then resume the run."
)


class WorkerPool:
    """The scheduler and the workers of a cluster, as far as an evaluation needs them.

    Each method raises `ClusterError` if the scheduler is gone.

    Args:
        client: The connection to the cluster.
        patience: Seconds to wait for a task to be done.

    Attributes:
        patience: As given.
    """

    def __init__(self, client: Any, *, patience: float) -> None:
        self._client = client
        self._distributed = import_distributed()
        self._gone = (
            OSError,
            self._distributed.CancelledError,
            self._distributed.client.ClosedClientError,
        )
        self._avoided: set[str] = set()
        self.patience = patience

    @property
    def avoids_workers(self) -> bool:
        """Whether there are workers that hang and cannot be restarted."""
        return bool(self._avoided)

    def workers(self) -> list[str]:
        """Return the addresses of the workers that may be used, once for each of their threads.

        Raises:
            ClusterError: All that there are hang and cannot be restarted.
        """
        with self._scheduler():
            threads = self._client.nthreads()
        usable = [worker for worker in threads if worker not in self._avoided]
        if threads and not usable:
            raise ClusterError(
                f"Expected a worker that answers, but all {len(threads)} of the cluster hang and "
                "have no nanny that could restart them; restart them, then resume the run."
            )
        return [worker for worker in usable for _ in range(threads[worker])]

    def submit(self, call: Callable[..., Any], *arguments: Any, workers: list[str]) -> Any:
        """Have something called on one of the workers, and return the future of its result."""
        only = {"workers": sorted(set(workers))} if self._avoided else {}
        with self._scheduler():
            return self._client.submit(call, *arguments, pure=False, **only)

    def wait(self, futures: list[Any]) -> list[Any]:
        """Return those that are done, at least one; none if that takes longer than patience."""
        with self._scheduler(), self._client.as_current():
            try:
                done, _ = self._distributed.wait(
                    futures, timeout=self.patience, return_when="FIRST_COMPLETED"
                )
            except TimeoutError:
                return []
        # A value that was lost with its worker is on its way again.
        return [future for future in done if future.status != "lost"] or self.wait(futures)

    def fetch(self, future: Any) -> tuple[int, Any]:
        """Return how many workers died of a task that Dask gave up, and else its result.

        The result is None, too, where it could not be fetched in time.
        """
        try:
            return 0, future.result(timeout=self.patience)
        except self._distributed.KilledWorker as killed:
            return killed.allowed_failures + 1, None
        except self._gone as error:
            if future.status == "error":  # The task raised it.
                raise
            if isinstance(error, TimeoutError):
                return 0, None
            raise ClusterError(_LOST) from error

    def placed(self, futures: Iterable[Any]) -> dict[Any, str]:
        """Return the worker of each task that is being worked on."""
        with self._scheduler():
            processing = self._client.processing()
        worker_of = {key: worker for worker, keys in processing.items() for key in keys}
        return {future: worker_of[future.key] for future in futures if future.key in worker_of}

    def free(self, workers: set[str]) -> None:
        """Restart workers that hang, and avoid those that cannot be restarted."""
        with self._scheduler():
            known = self._client.scheduler_info()["workers"]
            restarted = [worker for worker in workers if known.get(worker, {}).get("nanny")]
            self._avoided |= workers.difference(restarted)
            # It looks up each worker in the answer, where one that has just left is missing.
            with suppress(KeyError):
                self._client.restart_workers(
                    restarted, timeout=_RESTART_SECONDS, raise_for_error=False
                )

    def require_workers(self) -> None:
        """Raise an error if there are no workers.

        Raises:
            ClusterError: There are none.
        """
        if not self.workers():
            raise ClusterError(
                f"Expected a cluster with workers, but for {self.patience:g} seconds there was "
                "none; start some, then resume the run."
            )

    @contextmanager
    def _scheduler(self) -> Iterator[None]:
        if self._client.status == "closed":
            raise ClusterError(_LOST)
        try:
            yield
        except self._gone as error:
            raise ClusterError(_LOST) from error
