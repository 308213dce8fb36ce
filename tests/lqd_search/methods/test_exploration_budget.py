import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from lqd_search import BudgetError, ExplorationBudget


@pytest.mark.parametrize(
    ("evaluations", "batch_size", "short", "exploration"),
    [
        (102_400, 2_048, 5, 13 * 2_048),
        (20_480, 512, 4, 10 * 512),
        (8_192, 256, 3, 7 * 256),
        (1_000, 50, 2, 4 * 50),
    ],
)
def test_each_short_run_gets_a_tenth_and_shares_its_first_generation(
    evaluations, batch_size, short, exploration
):
    budget = ExplorationBudget(evaluations, batch_size, 3)
    assert budget.short_generations == short
    assert budget.exploration == exploration


def test_the_short_runs_come_one_after_the_other():
    budget = ExplorationBudget(2_000, 50, 3)
    turns = [budget.run_at(50 * generation) for generation in range(1, 12)]
    assert turns == [0, 0, 0, 1, 1, 1, 2, 2, 2, None, None]


@pytest.mark.parametrize(
    ("evaluations", "batch_size", "runs", "message"),
    [
        (1_000, 51, 3, "makes 1 of 51; use a batch size of at most 50"),
        (100, 512, 3, "makes 0 of 512; use a batch size of at most 5"),
        (19, 1, 3, "makes 1 of 1; spend at least 20 evaluations"),
        (0, 1, 3, "makes 0 of 1; spend at least 20 evaluations"),
        (1_000, 50, 0, "at least one fitness and a batch size of at least 1, but got 0 and 50"),
        (1_000, 0, 3, "at least one fitness and a batch size of at least 1, but got 3 and 0"),
        (1_000, 10, 11, "after a tenth of 1000 for each of 11 fitness .*; use at most 10 of these"),
    ],
)
def test_a_budget_that_does_not_suffice_says_what_would(evaluations, batch_size, runs, message):
    with pytest.raises(BudgetError, match=message):
        ExplorationBudget(evaluations, batch_size, runs)


@given(st.integers(20, 200_000), st.integers(1, 3_000), st.integers(1, 10))
def test_the_batch_size_that_would_do_does(evaluations, batch_size, runs):
    assume(evaluations // (10 * batch_size) < 2)
    with pytest.raises(
        BudgetError, match=f"at most {evaluations // 20}$|at most {evaluations // 20}\\."
    ):
        ExplorationBudget(evaluations, batch_size, runs)
    budget = ExplorationBudget(evaluations, evaluations // 20, runs)
    assert budget.exploration < evaluations
