"""What the report says of controls, caps and experts."""

import csv
import re

import numpy as np
import pytest
from click.testing import CliRunner

from benchmarks.instances.__main__ import main
from benchmarks.instances.fixed_motion import on_the_other_half
from benchmarks.instances.judged_run import InstancesError
from lqd_envs import get_task, rollout
from lqd_envs.instances import generate_instances

pytestmark = pytest.mark.usefixtures("drawn")


def invoke(*arguments):
    CliRunner().invoke(main, [str(a) for a in arguments], catch_exceptions=False)


def rows_of(out):
    with (out / "instances.csv").open(newline="") as file:
        return list(csv.DictReader(file))


def test_the_controls_are_those_of_the_simulation(make_run, fields, tmp_path):
    out = tmp_path / "out"
    found = generate_instances("LQD/Faucet-v0", "change", count=3, seed=5)

    arguments = ("--count", 3, "--seed", 5, "--jobs", 1, "--kinds", "change", "--out", out)
    invoke(make_run(), *arguments)

    task, approved = get_task("LQD/Faucet-v0"), fields["expert"]
    solves = np.stack(
        [rollout(one.apply(task), fields["solution"][approved]).success() for one in found]
    )
    # What nothing solves is left out of the report.
    solves = solves[solves.any(axis=1)]
    expected = {
        ("success", "best", "1"): solves[:, 0].mean(),
        ("one fixed motion", "hindsight", ""): solves.mean(axis=0).max(),
        ("one fixed motion", "other half", ""): on_the_other_half(solves).mean(),
    }
    assert len(solves) > 1
    values = {
        (row["figure"], row["choice"], row["tries"]): float(row["value"])
        for row in rows_of(out)
        if (row["filter"], row["size"]) == ("expert", "whole")
    }
    assert {key: values[key] for key in expected} == pytest.approx(expected)
    text = (out / "instances.md").read_text()
    assert "expert: the best in hindsight | expert: the best on the other half |" in text


def test_where_not_all_were_looked_at_the_tables_say_so(make_run, tmp_path):
    out = tmp_path / "out"

    invoke(
        make_run(),
        "--count",
        2,
        "--seed",
        0,
        "--jobs",
        1,
        "--kinds",
        "predicate,change",
        "--cap",
        "2",
        "--out",
        out,
    )

    glance, predicate, change = re.split("### .*", (out / "instances.md").read_text())
    rows = [line for line in glance.splitlines() if line.startswith("| faucet | ")]
    assert [row.split(" | ")[1] for row in rows] == ["predicate", "change"] * 6
    assert "some motion of at most 42 looked at solves it" not in predicate
    assert "some motion of at most 42 looked at solves it" in change
    assert "| of at most 42 looked at |" in change
    among = {
        (row["kind"], row["figure"], row["choice"], row["size"]): row["among"]
        for row in rows_of(out)
        if row["filter"] == "inferred"
    }
    assert {among[key] for key in among if key[0] == "predicate"} == {"all"}
    assert among["change", "some motion", "", "whole"] == "at most 42 looked at"
    assert among["change", "one fixed motion", "hindsight", "whole"] == "at most 42 looked at"
    assert among["change", "some motion", "", "1"] == "at most 2 drawn"
    assert among["change", "success", "random", "whole"] == "at most 2 drawn"
    assert among["change", "success", "best", "1"] == "at most 2 drawn"
    assert among["change", "success", "best", "whole"] == "all"


def test_motions_that_are_not_what_their_run_saw_are_counted(make_run, fields, tmp_path):
    out = tmp_path / "out"
    digest = fields["digest"].copy()
    digest[[1, 2]] += 1

    kinds = ("--kinds", "approach,predicate")
    invoke(make_run(digest=digest), "--count", 2, "--seed", 0, "--jobs", 1, *kinds, "--out", out)

    text = (out / "instances.md").read_text()
    assert "\n\n2 motions, simulated again in the task itself, were not bit for bit what" in text


def test_a_report_that_cannot_be_written_is_an_error_and_what_was_judged_is_kept(
    make_run, tmp_path
):
    out = tmp_path / "out"
    arguments = ("--count", 1, "--seed", 0, "--jobs", 1, "--kinds", "approach", "--out", out)
    (out / "instances.csv").mkdir(parents=True)

    with pytest.raises(
        InstancesError, match=r"Expected to write \S+instances.csv, but that failed"
    ):
        invoke(make_run(), *arguments)

    (out / "instances.csv").rmdir()
    invoke(*arguments)
    assert (out / "instances.csv").is_file()


def test_rows_of_what_the_expert_steered_are_marked(make_run, tmp_path):
    out = tmp_path / "out"
    runs = [make_run(name, method=name) for name in ("handcrafted", "direct")]

    invoke(*runs, "--count", 2, "--seed", 0, "--jobs", 1, "--kinds", "change", "--out", out)

    text = (out / "instances.md").read_text()
    rows = [line for line in text.splitlines() if line.startswith("| handcrafted")]
    assert len(rows) > 4
    assert all(row.startswith("| handcrafted (expert) |") for row in rows)
    assert "of `direct` it is the success function of the direct reply" in text
    assert "choose with an expert's knowledge" in text
    steering = {(row["method"], row["steering"]) for row in rows_of(out)}
    assert steering == {("handcrafted", "expert"), ("direct", "direct")}
