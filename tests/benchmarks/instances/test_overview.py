"""All tasks and kinds at one glance."""

from dataclasses import dataclass, replace

import pytest

from benchmarks.instances.figures import (
    BEST_IN_HINDSIGHT,
    BEST_ON_THE_OTHER_HALF,
    SomeMotion,
    Success,
)
from benchmarks.instances.overview import overview, overview_table
from benchmarks.instances.two_way import Rate

DRAWER, FAUCET = "LQD/Drawer-v0", "LQD/Faucet-v0"


@dataclass(frozen=True)
class Run:
    task: str
    method: str


@dataclass(frozen=True)
class FakeResults:
    """Rates by task, kind and method, of archives of which some are larger than looked at."""

    values: dict
    larger: frozenset = frozenset()
    figure: object = SomeMotion()

    @property
    def judgements(self):
        return [Run(task, method) for task, _, method in self.values]

    @property
    def instances(self):
        return dict.fromkeys((task, kind) for task, kind, _ in self.values)

    def methods(self, task):
        return [run.method for run in self.judgements if run.task == task]

    def capped(self, task, kind, by, *, methods):
        assert by == "inferred"
        return any((task, kind, method) in self.larger for method in methods)

    def rates(self, task, kind, method, by):
        assert by == "inferred"
        return {self.figure: Rate(self.values[task, kind, method], 0.0, 1.0)}

    def mean_rate(self, method, by, figure):
        assert by == "inferred"
        values = [self.values.get((*place, method)) for place in self.instances]
        if figure != self.figure or None in values:
            return None
        return Rate(sum(values) / len(values), 0.125, 0.875)


RESULTS = FakeResults(
    {
        (DRAWER, "predicate", "ours"): 0.5,
        (DRAWER, "predicate", "handcrafted"): 0.256,
        (FAUCET, "change", "ours"): 1.0,
        (FAUCET, "change", "random"): 0.25,
    },
    larger=frozenset({(DRAWER, "predicate", "ours"), (FAUCET, "change", "ours")}),
)


def test_rows_are_tasks_and_kinds_and_columns_are_methods():
    assert overview_table(RESULTS, SomeMotion()).splitlines() == [
        "| task | kind | handcrafted (expert) | ours | random |",
        "|---|---|---:|---:|---:|",
        "| drawer | predicate | 26% | ≥ 50% | - |",
        "| faucet | change | - | 100% | 25% |",
        "| mean |  | - | ≥ 75% [12, 88] | - |",
    ]


@pytest.mark.parametrize(
    ("figure", "bounds"),
    [
        (SomeMotion(), 2),
        (BEST_IN_HINDSIGHT, 2),
        (BEST_ON_THE_OTHER_HALF, 0),
        (Success("best", 5), 0),
    ],
)
def test_only_what_more_motions_could_raise_is_a_lower_bound(figure, bounds):
    assert overview_table(replace(RESULTS, figure=figure), figure).count("≥") == bounds


def test_nearly_all_is_not_all():
    nearly = FakeResults({(DRAWER, "change", "ours"): 0.9975}, larger=RESULTS.larger)

    assert overview_table(nearly, SomeMotion()).splitlines()[2] == "| drawer | change | > 99% |"


def test_what_all_solve_could_not_be_more():
    full = FakeResults(
        {(DRAWER, "change", "ours"): 0.5, (FAUCET, "change", "ours"): 1.0},
        larger=frozenset({(FAUCET, "change", "ours")}),
    )

    assert overview_table(full, SomeMotion()).splitlines()[-1] == "| mean |  | 75% [12, 88] |"


def test_nearly_nothing_may_be_anything():
    nearly = FakeResults({(DRAWER, "predicate", "ours"): 0.004}, larger=RESULTS.larger)

    assert overview_table(nearly, SomeMotion()).splitlines()[2] == "| drawer | predicate | ≥ 0% |"


def test_what_there_is_no_figure_of_is_no_zero():
    table = overview_table(RESULTS, BEST_ON_THE_OTHER_HALF)

    assert table.splitlines()[2] == "| drawer | predicate | - | - | - |"


def test_each_table_stands_below_what_it_says():
    parts = overview(RESULTS).split("\n\n")

    assert len(parts) == 13
    assert parts[1] == "Some motion of the archive solves the instance:"
    assert parts[2] == overview_table(RESULTS, SomeMotion())
