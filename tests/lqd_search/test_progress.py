import io

import pytest
from rich.console import Console

from lqd_search.cli.progress import RunProgress
from lqd_search.evaluation.values import Refusal
from lqd_search.runs.metrics import Metrics

LONGEST_STAGE = "exploring the_nearness_of_the_gripper_to_the_hot_tap (1 of 3)"


def metrics() -> Metrics:
    return Metrics(
        generation=30,
        stage=LONGEST_STAGE,
        evaluations=61_440,
        valid=30_000,
        rejected=30_000,
        discarded=1_440,
        refused=0,
        inferred_successes=1,
        expert_successes=2,
        archive_size=10,
        inferred_archive_size=1,
        success_archive_size=12_345,
        ground_truth_cells=2,
        coverage=0.1234,
        clipped=0,
        seconds=8.0,
    )


def shown(*, width: int, terminal: bool) -> str:
    text = io.StringIO()
    console = Console(file=text, width=width, force_terminal=terminal, color_system=None)
    with RunProgress("LQD/Faucet-v0 [a title]", total=102_400, console=console) as progress:
        progress.show(metrics())
    return text.getvalue()


@pytest.mark.parametrize("terminal", [False, True])
@pytest.mark.parametrize("width", [80, 100, 110, 160])
def test_no_figure_is_hidden(width, terminal):
    text = shown(width=width, terminal=terminal)

    assert "LQD/Faucet-v0 [a title]" in text
    # A terminal is sent the line again and again, each time over the one before.
    last = [line for line in text.replace("\r", "\n").splitlines() if "successes" in line][-1]
    for figure in ("61440/102400", "12,345 successes", "coverage 12.3%", "7,680/s", "explor"):
        assert figure in last


@pytest.mark.parametrize(("width", "bars"), [(80, False), (160, True)])
def test_there_is_a_bar_where_there_is_room(width, bars):
    assert ("━" in shown(width=width, terminal=True)) == bars


def test_a_refusal_is_told_as_a_note():
    text = io.StringIO()
    console = Console(file=text, width=300)
    with RunProgress("a title", total=10, console=console) as progress:
        progress.warn(Refusal("near", "fitness", 2, "returned NaN", 0), 7)

    assert "note: the fitness function 'near' returned NaN for motion 7" in text.getvalue()
