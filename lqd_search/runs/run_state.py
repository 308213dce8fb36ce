"""All that a run is after a generation."""

from dataclasses import dataclass, field

from lqd_search.evaluation.descriptor_report import DescriptorReport
from lqd_search.evaluation.values import StoppedFunction
from lqd_search.methods.method import Method
from lqd_search.runs.metrics import Metrics
from lqd_search.runs.run_config import RunConfig
from lqd_search.runs.tally import Tally


@dataclass
class RunState:
    """All that a run is after a generation: the content of its checkpoint.

    The outcomes are not in it: they are beside it, a file for each generation.

    Attributes:
        config: What the run was asked to do when it began.
        method: The method, told of every generation so far.
        tally: The run's counts.
        metrics: The figures of every generation so far.
        report: What the first batch showed of the descriptors; None before it.
        stopped: The functionals that were stopped so far, and that are not called any more.
        seconds: How long the run took so far, the time between being stopped and gone on with left
            out.
    """

    config: RunConfig
    method: Method
    tally: Tally = field(default_factory=Tally)
    metrics: list[Metrics] = field(default_factory=list)
    report: DescriptorReport | None = None
    stopped: tuple[StoppedFunction, ...] = ()
    seconds: float = 0.0
