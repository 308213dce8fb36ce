"""The tutorial of a search of one's own: its code is that of its example, and all of it runs."""

import re
import subprocess
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "examples" / "own_search.py"
TUTORIAL = ROOT / "docs" / "tutorials" / "own-search.md"
BLOCKS = re.findall(
    r"^```python\n(.*?)^```$", TUTORIAL.read_text("utf-8"), re.DOTALL | re.MULTILINE
)


def test_the_first_block_is_the_example():
    assert BLOCKS[0] == EXAMPLE.read_text("utf-8")


def test_the_example_finds_throws_that_hit():
    run = subprocess.run(
        [sys.executable, EXAMPLE], capture_output=True, text=True, check=True, timeout=300
    )

    found, hits = map(int, re.fullmatch(r"(\d+) throws, (\d+) of them hit\n", run.stdout).groups())
    assert found > hits > 300


def test_what_a_search_found_can_be_kept(monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    namespace = {}
    few = BLOCKS[0].replace("20_000", "1_000")

    exec(compile(few + BLOCKS[1], str(TUTORIAL), "exec"), namespace)

    archive, elites = namespace["archive"], namespace["elites"]
    np.testing.assert_array_equal(archive.fields["solution"], elites.fields["solution"])
    assert set(archive.grids) == {"flight", "throw"}
    assert namespace["method"].done


def test_pyribs_scheduler_runs_on_the_archive():
    namespace = {}

    exec(compile(BLOCKS[2], str(TUTORIAL), "exec"), namespace)

    elites = namespace["archive"].elites()
    assert elites.successes > 0
    assert all(len(grid) > 10 for grid in namespace["archive"].grids.values())


def test_what_pyribs_stores_is_what_was_measured():
    namespace = {}

    exec(compile(BLOCKS[2], str(TUTORIAL), "exec"), namespace)

    throws = namespace["archive"].grid_elites("throw")
    across, up = throws["solution"].T
    np.testing.assert_allclose(throws["measures"][:, 0], np.hypot(across, up))
    np.testing.assert_allclose(throws["measures"][:, 1], np.arctan2(up, across))
    assert throws["solution"].min() >= 0.0
    assert throws["solution"].max() <= 15.0


def test_own_functionals_judge_motions():
    namespace = {}

    exec(compile(BLOCKS[3], str(TUTORIAL), "exec"), namespace)

    values = namespace["values"]
    assert namespace["judge"].descriptors == {"start.gripper": 3, "end.gripper": 3}
    assert values.valid.any()
    assert np.isfinite(values.measures["end.gripper"][values.valid]).all()
    assert np.isfinite(values.fitness["opening"][values.valid]).all()
