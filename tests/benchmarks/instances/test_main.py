"""`python -m benchmarks.instances`."""

import csv
import gzip
import json
import re

import pytest
from click.testing import CliRunner

from benchmarks.instances import __main__ as instances
from benchmarks.instances.declared import INSTANCE_SEED
from benchmarks.instances.judged_run import InstancesError
from benchmarks.instances.judging import Judging
from benchmarks.tables.machine import describe_machine
from lqd_envs.instances import InstanceError

COUNT = ("--count", "2", "--seed", "0", "--jobs", "1")


def invoke(*arguments):
    return CliRunner().invoke(instances.main, [str(a) for a in arguments], catch_exceptions=False)


def rows_of(out):
    with (out / "instances.csv").open(newline="") as file:
        return list(csv.DictReader(file))


def lines_of(path):
    return gzip.decompress(path.read_bytes()).decode().splitlines()


def write_lines(path, lines):
    path.write_bytes(gzip.compress("".join(f"{line}\n" for line in lines).encode()))


def judged_in(out):
    """The judgements that are kept, by their file and instance."""
    return {
        (path.name, one["instance"]): one
        for path in (out / "judged").iterdir()
        for one in map(json.loads, lines_of(path))
    }


@pytest.fixture
def runs(make_run):
    """Return two runs of one method and one of another, with different archives."""
    return [
        make_run("a", rows=slice(0, 8)),
        make_run("b", rows=slice(0, 4), seed=1),
        make_run("c", rows=slice(5, 8), method="random"),
    ]


def test_tables_csv_and_pictures_are_written(runs, tmp_path):
    out = tmp_path / "out"

    result = invoke(*runs, *COUNT, "--out", out)

    assert result.exit_code == 0
    assert result.stdout.splitlines() == [f"{out}/instances.md", f"{out}/instances.csv"]
    text = (out / "instances.md").read_text()
    for kind in ("Predicate", "Obstacles", "Approach", "Change"):
        assert f"### {kind}\n" in text
    assert "| ours | 2 | " in text
    assert "| random | 1 | 3 | 3 |" in text
    assert "3 runs of 100 evaluations, judged by the first instances of seed 0." in text
    assert "| inferred: motions | looked at | some motion solves it | expert: " in text
    assert "(expert)" not in text
    section = text.split("## How it was judged")[1]
    assert "24 judgements took 0.0 hours, with simulation on 1 thread." in section
    assert f"Machine: {describe_machine()}." in section
    assert "; mujoco " in section
    assert re.search(r"^Commit: \S+\.$", section, re.MULTILINE)
    png = (out / "pictures" / "sizes.faucet.png").read_bytes()
    assert png.startswith(b"\x89PNG")
    assert (out / "pictures" / "sizes.faucet.svg").stat().st_size > 1000
    assert len(judged_in(out)) == 3 * 4 * 2


def test_rates_are_the_means_of_the_judgements(runs, tmp_path, drawn):
    out = tmp_path / "out"
    invoke(*runs, *COUNT, "--kinds", "change", "--out", out)

    judged = judged_in(out).values()
    figures = [one["filters"]["inferred"] for one in judged if one["run"]["method"] == "ours"]
    assert len(figures) == 4
    solvable = {one["instance"] for one in judged if one["solved"]}
    assert len(solvable) == 2
    (row,) = (
        row
        for row in rows_of(out)
        if (row["method"], row["filter"], row["figure"], row["size"])
        == ("ours", "inferred", "some motion", "1")
    )
    assert float(row["value"]) == pytest.approx(
        sum(one["solved"] / one["judged"] for one in figures) / 4
    )
    assert (row["runs"], row["instances"]) == ("2", "2")
    assert float(row["low"]) <= float(row["value"]) <= float(row["high"])
    (row,) = (
        row
        for row in rows_of(out)
        if (row["method"], row["filter"], row["choice"], row["tries"], row["size"])
        == ("ours", "inferred", "best", "5", "whole")
    )
    assert float(row["value"]) == sum(0 < one["first"]["best"] <= 5 for one in figures) / 4
    assert drawn == ["sizes.faucet"]


def test_the_default_seed_is_one_that_nobody_has_looked_at():
    (option,) = (option for option in instances.main.params if option.name == "seed")

    assert option.default == INSTANCE_SEED == 1000


def test_a_run_that_was_made_again_is_not_mixed_with_what_was_judged_of_it(
    make_run, tmp_path, drawn
):
    out = tmp_path / "out"
    invoke(make_run("a"), *COUNT, "--kinds", "approach", "--out", out)
    (judged,) = (out / "judged").iterdir()

    with pytest.raises(InstancesError, match=f"; delete {judged}, or choose another folder"):
        invoke(make_run("b", rows=slice(0, 4)), *(*COUNT, "--kinds", "approach", "--out", out))
    assert drawn == ["sizes.faucet"]


@pytest.mark.usefixtures("drawn")
def test_what_was_judged_with_other_declarations_is_judged_again(make_run, tmp_path):
    out = tmp_path / "out"
    arguments = (*COUNT, "--kinds", "change", "--out", out)
    invoke(make_run("a"), *arguments)
    before = (out / "instances.csv").read_bytes()
    (path,) = (out / "judged").iterdir()
    first, *others = lines_of(path)
    judged = json.loads(first)
    write_lines(path, [json.dumps(judged | {"declared": "0" * 16}), *others])

    with pytest.raises(InstancesError, match="and all else as it is declared now, but it is not"):
        invoke(*arguments)
    assert invoke(tmp_path / "a", *arguments).exit_code == 0

    assert {json.loads(line)["declared"] for line in lines_of(path)} == {judged["declared"]}
    assert (out / "instances.csv").read_bytes() == before


@pytest.mark.usefixtures("drawn")
def test_what_no_run_solves_is_named_and_left_out(make_run, tmp_path):
    out = tmp_path / "out"
    # Only the motion that stays in the air.
    result = invoke(make_run(rows=slice(7, 8)), *COUNT, "--kinds", "approach", "--out", out)

    assert result.exit_code == 0
    text = (out / "instances.md").read_text()
    head = "0 of 2 instances are solved by a motion of some run; the others are left out: `faucet-"
    assert head in text
    assert rows_of(out) == []


@pytest.mark.usefixtures("drawn")
def test_what_one_run_solves_counts_for_all(make_run, tmp_path):
    out = tmp_path / "out"
    invoke(
        make_run("a"),
        make_run("b", rows=slice(7, 8), method="random"),
        *(*COUNT, "--kinds", "change", "--out", out),
    )

    values = {
        row["method"]: (float(row["value"]), row["instances"])
        for row in rows_of(out)
        if (row["filter"], row["figure"], row["size"]) == ("inferred", "some motion", "whole")
    }
    assert values == {"ours": (1.0, "2"), "random": (0.0, "2")}


@pytest.mark.usefixtures("drawn")
def test_what_is_judged_is_not_judged_again(runs, tmp_path, monkeypatch):
    out = tmp_path / "out"
    invoke(*runs[:2], *COUNT, "--out", out)
    before = judged_in(out)
    asked = []
    judge = Judging.judge

    def spy(self, wanted):
        asked.append([instance.kind for instance in wanted])
        return judge(self, wanted)

    monkeypatch.setattr(Judging, "judge", spy)
    path = next((out / "judged").iterdir())
    *lines, last = sorted(lines_of(path), key=lambda line: "faucet-change-" in line)
    write_lines(path, lines)

    result = invoke(*runs, *COUNT, "--out", out)

    assert result.exit_code == 0
    assert [len(kinds) for kinds in asked] == [1, 8]
    assert asked[0] == ["change"]
    after = judged_in(out)
    assert len(after) == 24
    # What is judged again may have taken another time.
    again = (path.name, json.loads(last)["instance"])
    assert again in after
    assert all(after[name] == one for name, one in before.items() if name != again)


@pytest.mark.usefixtures("drawn")
def test_a_run_that_was_stopped_goes_on_and_ends_as_if_it_had_not_been(runs, tmp_path, monkeypatch):
    whole, parted = tmp_path / "whole", tmp_path / "parted"
    invoke(*runs, *COUNT, "--out", whole)
    judge_own, judged = Judging._judge_own, []

    def stop(self, instance):
        judged.append(instance)
        if len(judged) == 3:
            raise KeyboardInterrupt
        return judge_own(self, instance)

    with monkeypatch.context() as patch:
        patch.setattr(Judging, "_judge_own", stop)
        patch.setattr("sys.argv", ["instances", "a run", "--count", "2"])
        stopped = invoke(*runs, *COUNT, "--out", parted)
    assert stopped.exit_code == 130
    assert stopped.output.splitlines()[-1] == (
        "stopped; what has been judged is kept: go on with `python -m benchmarks.instances 'a run' "
        "--count 2`"
    )
    # Four of the task's own dynamics, and two of the others.
    assert len(judged_in(parted)) == 6
    assert not (parted / "instances.md").exists()

    assert invoke(*runs, *COUNT, "--out", parted).exit_code == 0

    for name in ("instances.md", "instances.csv"):
        assert (parted / name).read_bytes() == (whole / name).read_bytes()


@pytest.mark.usefixtures("drawn")
def test_without_runs_the_tables_are_those_of_what_is_judged(runs, tmp_path):
    out = tmp_path / "out"
    invoke(*runs, *COUNT, "--out", out)
    before = (out / "instances.csv").read_bytes()
    (out / "instances.csv").unlink()

    assert invoke(*COUNT, "--out", out).exit_code == 0

    assert (out / "instances.csv").read_bytes() == before


@pytest.mark.usefixtures("drawn")
def test_without_runs_what_is_not_judged_is_an_error(runs, tmp_path):
    out = tmp_path / "out"
    invoke(runs[0], *COUNT, "--out", out)

    with pytest.raises(InstancesError, match=r"Expected what faucet\.ours\.\S+ came to in"):
        invoke("--count", 3, "--seed", 0, "--out", out)
    with pytest.raises(InstancesError, match="Expected runs to judge, or judgements in"):
        invoke(*COUNT, "--out", tmp_path / "nothing")


def test_unknown_kinds_are_refused(runs, tmp_path):
    with pytest.raises(InstanceError, match="Expected kinds among predicate, obstacles, approach"):
        invoke(runs[0], "--kinds", "change,weather", "--out", tmp_path / "out")
