import dataclasses

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lqd_envs import GroundTruth
from lqd_search import Values
from lqd_search.runs.outcome_archive import OutcomeArchive
from lqd_search.runs.stored_outcomes import OutcomeError
from lqd_search.runs.success_archive import SuccessArchive

GRID = GroundTruth(
    descriptor=lambda columns: columns, names=("a", "b"), dims=(2, 3), ranges=((0, 1), (0, 3))
)


def evaluate(solutions, **changes):
    """Whatever these solutions say: two measures, and which conditions approve."""
    x, y, success, expert = solutions.T
    valid = ~np.isnan(x)
    values = Values(
        valid=valid,
        success=valid & (success > 0),
        fitness={"near": np.where(x > 0.5, np.nan, x)},
        measures={"end.place": solutions[:, :2].copy(), "end.x": solutions[:, :1].copy()},
        passive={
            "expert": valid & (expert > 0),
            "ground_truth": np.where((y >= 0)[:, None], solutions[:, :2], np.nan),
            "digest": np.arange(len(x), dtype=np.uint64),
        },
    )
    return dataclasses.replace(values, **changes)


def rows(*solutions):
    return np.array(solutions, np.float64).reshape(-1, 4)


FIRST = rows(
    (0.2, 0.5, 1, 1),  # both, cell 0
    (0.3, 0.5, 0, 0),  # none
    (0.9, 2.5, 0, 1),  # expert only, cell 5
    (0.2, 0.5, 1, 1),  # again the first
    (0.1, 0.6, 1, 0),  # the run's only
    (0.4, 9.0, 0, 1),  # outside the grid
    (0.4, -1.0, 1, 1),  # undefined ground truth
)


def test_every_success_by_either_condition_is_kept_once():
    archive = OutcomeArchive(GRID)
    block = archive.add(FIRST, evaluate(FIRST), evaluation=10)
    kept = [0, 2, 4, 5, 6]
    values = evaluate(FIRST)
    assert list(block) == [
        "solution",
        "evaluation",
        "success",
        "expert",
        "ground_truth",
        "digest",
        "fitness/near",
        "measures/end.place",
        "measures/end.x",
    ]
    assert block["evaluation"].tolist() == [10 + i for i in kept]
    expected = {
        "solution": FIRST,
        "success": values.success,
        **values.passive,
        "fitness/near": values.fitness["near"],
        "measures/end.place": values.measures["end.place"],
    }
    for name, column in expected.items():
        np.testing.assert_array_equal(block[name], column[kept])
        assert block[name].dtype == column.dtype
    assert np.isnan(block["fitness/near"][1])
    assert len(archive) == 5


def test_the_figures():
    archive = OutcomeArchive(GRID)
    archive.add(FIRST, evaluate(FIRST), evaluation=0)
    figures = archive.figures
    assert dataclasses.asdict(figures) == {
        "both": 2,
        "success_only": 1,
        "expert_only": 2,
        "cells": 2,
        "outside": 2,
    }
    assert (figures.outcomes, figures.success, figures.expert) == (5, 3, 4)


def test_what_was_there_before_is_not_new():
    archive = OutcomeArchive(GRID)
    archive.add(FIRST, evaluate(FIRST), evaluation=0)
    before = archive.figures
    second = rows((0.2, 0.5, 1, 1), (0.25, 0.5, 1, 1), (0.3, 0.5, 0, 0))
    block = archive.add(second, evaluate(second), evaluation=7)
    assert block["evaluation"].tolist() == [8]
    assert archive.figures == dataclasses.replace(before, both=before.both + 1)
    third = rows((0.25, 0.5, 1, 1))
    assert len(archive.add(third, evaluate(third), evaluation=10)["solution"]) == 0
    assert archive.outcomes()["evaluation"].tolist() == [0, 2, 4, 5, 6, 8]


def test_zero_is_zero_with_either_sign():
    archive = OutcomeArchive(GRID)
    solutions = rows((-0.0, 0.5, 1, 1), (0.0, 0.5, 1, 1))
    block = archive.add(solutions, evaluate(solutions), evaluation=0)
    assert block["evaluation"].tolist() == [0]


@st.composite
def generations(draw):
    numbers = st.sampled_from([-1.0, -0.0, 0.0, 0.4, 1.0, 2.9, 7.0])
    flags = st.sampled_from([0.0, 1.0])
    solution = st.tuples(numbers, numbers, flags, flags)
    return [rows(*g) for g in draw(st.lists(st.lists(solution, max_size=8), min_size=1))]


def told(batches):
    archive, blocks, evaluation = OutcomeArchive(GRID), [], 0
    for solutions in batches:
        blocks.append(archive.add(solutions, evaluate(solutions), evaluation=evaluation))
        evaluation += len(solutions)
    return archive, blocks


@given(generations())
def test_the_figures_are_those_of_all_distinct_successes(batches):
    archive, _ = told(batches)
    figures = archive.figures
    everything = np.concatenate(batches) + 0.0
    approved = {tuple(row) for row in everything.tolist() if row[2] or row[3]}
    judged = SuccessArchive.of(
        {key: archive.outcomes()[key] for key in ("success", "expert", "ground_truth")},
        ground_truth=GRID,
    )
    assert {tuple(row) for row in (archive.outcomes()["solution"] + 0.0).tolist()} == approved
    assert len(archive) == len(approved) == figures.outcomes
    assert figures.both == sum(1 for row in approved if row[2] and row[3])
    assert (figures.success, figures.expert) == (judged.inferred, judged.size)
    assert (figures.cells, figures.outside) == (len(judged.cells), judged.outside)


@given(generations(), st.data())
def test_rebuilt_from_its_blocks_it_goes_on_as_if_nothing_had_happened(batches, data):
    archive, blocks = told(batches)
    cut = data.draw(st.integers(0, len(batches)))
    again = OutcomeArchive.from_blocks(blocks[:cut], ground_truth=GRID)
    evaluation = sum(map(len, batches[:cut]))
    for solutions, block in zip(batches[cut:], blocks[cut:], strict=True):
        read = again.add(solutions, evaluate(solutions), evaluation=evaluation)
        evaluation += len(solutions)
        assert {name: c.tobytes() for name, c in read.items()} == (
            {name: c.tobytes() for name, c in block.items()}
        )
    assert again.figures == archive.figures
    assert again.to_bytes() == archive.to_bytes()
    assert OutcomeArchive.from_blocks([archive.outcomes()], ground_truth=GRID).figures == (
        archive.figures
    )


def test_an_archive_that_was_told_nothing_has_no_columns():
    with pytest.raises(OutcomeError, match="at least one generation, but got none"):
        OutcomeArchive(GRID).to_bytes()
    assert OutcomeArchive(GRID).figures.outcomes == 0


@pytest.mark.parametrize(
    ("solutions", "changes", "evaluation", "message"),
    [
        (rows((0.1, 0.1, 1, 1)), {}, 3, "evaluations after 6, but got 3; tell each generation"),
        (rows((0.1, 0.1, 1, 1)), {"fitness": {}}, 7, r"but they differ in fitness/near; they are"),
        (
            rows((0.1, 0.1, 1, 1)),
            {"measures": {"end.place": np.zeros((1, 3)), "end.x": np.zeros((1, 1))}},
            7,
            r"but they differ in measures/end\.place; they are those of different runs",
        ),
        (rows((0.1, 0.1, 1, 1)), {"passive": {}}, 7, "'expert' among the values, but there are on"),
        (
            rows((0.1, 0.1, 1, 1)),
            {
                "passive": {
                    "expert": np.ones(1, bool),
                    "ground_truth": np.zeros((1, 2)),
                    "digest": np.zeros(1, np.int64),
                }
            },
            7,
            "1 dimensions of uint64 in digest, got 1 of int64; convert the column",
        ),
    ],
)
def test_after_a_refusal_nothing_has_changed(solutions, changes, evaluation, message):
    archive = OutcomeArchive(GRID)
    archive.add(FIRST, evaluate(FIRST), evaluation=0)
    before = archive.figures, archive.to_bytes()
    with pytest.raises(OutcomeError, match=message):
        archive.add(solutions, evaluate(solutions, **changes), evaluation=evaluation)
    assert (archive.figures, archive.to_bytes()) == before
    assert len(archive.add(solutions, evaluate(solutions), evaluation=7)["solution"]) == 1


def test_another_number_of_values_is_refused():
    with pytest.raises(OutcomeError, match="the values of 7 solutions, but got 2"):
        OutcomeArchive(GRID).add(FIRST, evaluate(FIRST[:2]), evaluation=0)


def test_blocks_that_are_not_those_of_a_run_are_refused():
    _, (block,) = told([FIRST])
    later = {**block, "evaluation": block["evaluation"] + 20}
    with pytest.raises(OutcomeError, match="each outcome once, but a solution is there twice"):
        OutcomeArchive.from_blocks([block, later], ground_truth=GRID)
    doubled = {name: np.concatenate([block[name], later[name]]) for name in block}
    with pytest.raises(OutcomeError, match="each outcome once"):
        OutcomeArchive.from_blocks([doubled], ground_truth=GRID)
    others = {**later, "solution": block["solution"] + 1.0}
    with pytest.raises(OutcomeError, match="evaluations after 26, but got 0"):
        OutcomeArchive.from_blocks([others, block], ground_truth=GRID)
