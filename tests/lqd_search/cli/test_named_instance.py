"""Instances as they are named on the command line."""

from dataclasses import replace

from lqd_envs import get_task
from lqd_envs.instances import KINDS
from lqd_envs.tasks import registry
from lqd_search.cli.named_instance import listed_instances


def test_a_kind_that_cannot_be_drawn_for_a_task_says_so_and_the_others_are_listed(
    monkeypatch,
):
    # No generator of predicates knows this task.
    own = replace(get_task("LQD/Faucet-v0"), id="Home/Sink-v0")
    monkeypatch.setattr(registry, "TASKS", {own.id: own})

    lines = listed_instances(own, count=2).splitlines()

    at = lines.index("predicate  none")
    assert lines[at + 1] == (
        "  Expected one of the paper's tasks to draw a predicate for, but got Home/Sink-v0; make "
        "Instances of it from predicates of your own."
    )
    for kind in set(KINDS) - {"predicate"}:
        assert sum(line.startswith(f"{kind}:") for line in lines) == 2
