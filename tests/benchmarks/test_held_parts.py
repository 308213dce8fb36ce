"""What of the mug the pads touch, and what `HeldPart` says of it."""

from collections import Counter

import numpy as np
import pytest
from click.testing import CliRunner

from benchmarks.held_parts import count_pairs, describe, main, part_named, part_touched
from lqd_envs import LQDError, rollout

GRASP = "LQD/Grasp-v0"
# A grasp of the handle, of the rim, around the body, and a motion that stays in the air.
SOLUTIONS = np.array(
    [
        (-0.16, 0.44, 0.11, 1.24, -1.12, -2.23, 0.32, 0.06, 0.24),
        (-0.43, -0.01, 0.27, 0.67, 0.55, -1.06, 0.59, -0.54, 0.19),
        (-0.08, -0.09, 0.11, -0.04, 0.38, 0.86, 0.29, 0.13, 0.16),
        (0.0, 0.0, 0.9, 0.0, 0.0, 0.0, 0.0, 0.0, 0.5),
    ]
)


@pytest.fixture
def make_run(make_folder):
    def make(task):
        motions, approved = rollout(GRASP, SOLUTIONS), np.array([True, True, True, False])
        fields = {
            "solution": SOLUTIONS,
            "objective": np.zeros(4),
            "success": approved,
            "expert": approved,
            "evaluation": np.arange(4),
            "ground_truth": motions.ground_truth(),
            "digest": motions.digests(),
        }
        return make_folder("run", fields, task=task)

    return make


@pytest.mark.parametrize(
    ("left", "right", "part"),
    [
        ({"handle"}, {"handle"}, "handle"),
        ({"inside"}, {"outside"}, "rim"),
        ({"outside"}, {"inside"}, "rim"),
        ({"outside"}, {"outside"}, "body"),
        ({"inside"}, {"inside"}, None),
        ({"handle"}, {"outside"}, None),
        ({"handle", "outside"}, {"handle"}, None),
        ({"bottom"}, {"outside"}, None),
        (set(), {"outside"}, None),
        (set(), set(), None),
    ],
)
def test_the_part_is_what_both_pads_touch(left, right, part):
    assert part_touched(frozenset(left), frozenset(right)) == part


def test_what_touches_nothing_is_named_nothing():
    named = part_named(rollout(GRASP, SOLUTIONS))

    assert named == ["handle", "rim", "body", None]


def test_grasps_of_an_archive_are_counted(make_run):
    run = make_run(GRASP)

    assert count_pairs(run, most=90, seed=0) == {(p, p): 1 for p in ("handle", "rim", "body")}
    assert count_pairs(run, most=2, seed=0).total() == 2
    result = CliRunner().invoke(main, [str(run)])
    assert result.output.splitlines()[2] == "| handle | 1 | 0 | 0 | 0 |"


def test_a_run_of_another_task_is_refused(make_run):
    with pytest.raises(LQDError, match=r"a run of LQD/Grasp-v0, but .* is one of LQD/Push-v0"):
        count_pairs(make_run("LQD/Push-v0"), most=90, seed=0)


def test_the_table_has_a_row_for_each_part_that_is_touched():
    counts = Counter({("handle", "handle"): 3, ("handle", "body"): 1, (None, None): 2})

    assert describe(counts).splitlines() == [
        "| the pads touch | handle | rim | body | none |",
        "|---|---:|---:|---:|---:|",
        "| handle | 3 | 0 | 1 | 0 |",
        "| rim | 0 | 0 | 0 | 0 |",
        "| body | 0 | 0 | 0 | 0 |",
        "| several, or one pad alone | 0 | 0 | 0 | 2 |",
    ]
