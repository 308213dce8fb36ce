import numpy as np

from lqd_envs import get_task
from lqd_search.runs.success_archive import SuccessArchive


def test_only_what_the_expert_approves_counts_and_only_inside_the_grid_as_a_cell():
    ground_truth = get_task("LQD/Faucet-v0").ground_truth
    output = {
        "success": np.array([True, False, True, True, False]),
        "expert": np.array([True, True, True, False, True]),
        "ground_truth": np.array([[0.5], [0.5], [1.0], [1.5], [99.0]]),
    }

    archive = SuccessArchive.of(output, ground_truth=ground_truth)

    assert archive.elites == 5
    assert archive.inferred == 3
    assert archive.size == 4
    assert archive.cells.tolist() == [23, 47]
    assert archive.counts.tolist() == [2, 1]
    assert archive.outside == 1
