import io
from dataclasses import replace
from pathlib import Path

import pytest
from rich.console import Console

from lqd_search.cli.progress import RunProgress
from lqd_search.evaluation.values import Refusal

LONGEST_STAGE = "exploring the_nearness_of_the_gripper_to_the_hot_tap (1 of 3)"


@pytest.fixture
def metrics(make_metrics):
    return make_metrics(
        30,
        stage=LONGEST_STAGE,
        evaluations=61_440,
        success_archive_size=12_345,
        coverage=0.1234,
        seconds=8.0,
    )


def shown(metrics, *, width: int, terminal: bool) -> str:
    text = io.StringIO()
    console = Console(file=text, width=width, force_terminal=terminal, color_system=None)
    with RunProgress(
        "LQD/Faucet-v0 [a title]", total=102_400, folder=Path("runs/[one]"), console=console
    ) as progress:
        progress.show(metrics)
    return text.getvalue()


def last_line(text: str) -> str:
    # A terminal is sent the line again and again, each time over the one before.
    return [line for line in text.replace("\r", "\n").splitlines() if "successes" in line][-1]


@pytest.mark.parametrize("terminal", [False, True])
@pytest.mark.parametrize("width", [80, 100, 110, 160])
def test_no_figure_is_hidden(metrics, width, terminal):
    text = shown(metrics, width=width, terminal=terminal)

    assert "LQD/Faucet-v0 [a title]\nRun folder: runs/[one]\n" in text.replace("\r", "")
    for figure in ("61440/102400", "12,345 successes", "coverage 12.3%", "7,680/s", "explor"):
        assert figure in last_line(text)


@pytest.mark.parametrize("terminal", [False, True])
def test_without_grids_there_is_no_coverage(metrics, terminal):
    text = shown(replace(metrics, coverage=None), width=80, terminal=terminal)

    assert "12,345 successes, 7,680/s" in last_line(text)
    assert "coverage" not in text


@pytest.mark.parametrize(("width", "bars"), [(80, False), (160, True)])
def test_there_is_a_bar_where_there_is_room(metrics, width, bars):
    assert ("━" in shown(metrics, width=width, terminal=True)) == bars


def test_a_refusal_is_told_as_a_note():
    text = io.StringIO()
    console = Console(file=text, width=300)
    with RunProgress("a title", total=10, folder=Path("one"), console=console) as progress:
        progress.warn(Refusal("near", "fitness", 2, "returned NaN", 0), 7)

    assert "note: the fitness function 'near' returned NaN for motion 7" in text.getvalue()
