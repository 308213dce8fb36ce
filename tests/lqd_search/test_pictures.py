import io

import matplotlib.image
import numpy as np
import pytest

from lqd_envs import GroundTruth, get_task
from lqd_search.archives.grid_spec import GridSpec
from lqd_search.pictures import draw_curves, draw_ground_truth, draw_heat_map
from lqd_search.runs.metrics import Metrics
from lqd_search.runs.stored_archive import StoredGrid
from lqd_search.runs.success_archive import SuccessArchive


def pixels(png: bytes):
    return matplotlib.image.imread(io.BytesIO(png), format="png")


def metrics(generation: int, stage: str) -> Metrics:
    return Metrics(
        generation=generation,
        stage=stage,
        evaluations=10 * generation,
        valid=1,
        rejected=1,
        discarded=1,
        refused=0,
        inferred_successes=0,
        expert_successes=0,
        archive_size=generation,
        inferred_archive_size=generation,
        success_archive_size=2 * generation,
        ground_truth_cells=1,
        coverage=0.01 * generation,
        clipped=0,
        seconds=1.0,
    )


def test_curves_are_drawn_for_every_stage():
    rows = [metrics(1, "first batch"), metrics(2, "exploring a"), metrics(3, "continuing with a")]

    picture = pixels(draw_curves(rows, title="a run"))

    assert picture.shape[0] > 300
    assert picture.std() > 0.05


@pytest.mark.parametrize("dimensions", [2, 3, 5])
def test_a_heat_map_has_a_panel_for_each_pair_of_measures(dimensions):
    cells = np.array([0, 1, 3])
    grid = StoredGrid(
        spec=GridSpec(dims=(2,) * dimensions, ranges=((0.0, 1.0),) * dimensions),
        cells=cells,
        elites=np.array([0, 1, 2]),
        measures=np.zeros((3, dimensions)),
    )

    picture = pixels(
        draw_heat_map("start.pose", grid, fields={"success": np.array([True, False, True])})
    )

    panels = dimensions * (dimensions - 1) // 2
    assert picture.shape[1] > picture.shape[0] * min(panels, 3) / (-(-panels // 3)) * 0.7
    assert picture.std() > 0.05


def test_a_heat_map_of_failures_alone_is_drawn():
    grid = StoredGrid(
        spec=GridSpec(dims=(1, 4), ranges=((0.0, 1.0), (0.0, 1.0))),
        cells=np.array([2]),
        elites=np.array([0]),
        measures=np.zeros((1, 2)),
    )

    assert pixels(draw_heat_map("a.b", grid, fields={"success": np.array([False])})).std() > 0.02


def successes(cells, counts) -> SuccessArchive:
    return SuccessArchive(
        elites=9,
        inferred=4,
        size=5,
        cells=np.array(cells, dtype=np.int64),
        counts=np.array(counts),
        outside=0,
    )


def test_a_ground_truth_of_one_dimension_is_drawn_as_bars():
    ground_truth = get_task("LQD/Faucet-v0").ground_truth

    few = pixels(draw_ground_truth(ground_truth, successes([20], [5])))
    none = pixels(draw_ground_truth(ground_truth, successes([], [])))

    assert few.shape == none.shape
    assert (few != none).any()


def test_a_ground_truth_of_three_dimensions_is_drawn_pair_by_pair():
    ground_truth = GroundTruth(
        descriptor=lambda columns: columns.gripper_position[:, 0],
        names=("x (m)", "y (m)", "z (m)"),
        dims=(3, 4, 5),
        ranges=((0.0, 1.0),) * 3,
    )

    picture = pixels(draw_ground_truth(ground_truth, successes([0, 7, 59], [1, 2, 2])))

    assert picture.shape[1] > 2 * picture.shape[0]
