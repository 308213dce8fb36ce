"""What a judgement was made on, and how long it took."""

from dataclasses import dataclass, replace

from benchmarks.tables.machine import describe_commit, describe_machine
from lqd_search.runs.run_config import installed_versions


@dataclass(frozen=True)
class Provenance:
    """What a judgement was made on, and how long it took.

    Attributes:
        machine: System, processor and number of CPUs.
        commit: Of the sources, with a `+` where they were changed; empty where there is no git.
        versions: Of Python and of every package whose version can change a result.
        threads: Threads that simulated.
        seconds: How long it took, in s; of judgements that share a simulation, the equal share.
    """

    machine: str
    commit: str
    versions: dict[str, str]
    threads: int
    seconds: float

    @classmethod
    def here(cls, *, threads: int) -> "Provenance":
        """Return that of a judgement that begins on this machine.

        Args:
            threads: Threads that simulate.
        """
        return cls(describe_machine(), describe_commit(), installed_versions(), threads, 0.0)

    def took(self, seconds: float) -> "Provenance":
        """Return the same after so many s."""
        return replace(self, seconds=round(seconds, 3))
