import io
from dataclasses import replace

import matplotlib.image
import numpy as np
import pytest

from lqd_envs import GroundTruth, get_task
from lqd_search.archives.grid_spec import GridSpec
from lqd_search.pictures import draw_curves, draw_ground_truth, draw_heat_map
from lqd_search.runs.stored_archive import StoredGrid
from lqd_search.runs.success_archive import SuccessArchive


def pixels(png: bytes):
    return matplotlib.image.imread(io.BytesIO(png), format="png")


@pytest.fixture
def rows(make_metrics):
    stages = ("first batch", "exploring a", "continuing with a")
    return [make_metrics(i, stage=stage) for i, stage in enumerate(stages, 1)]


def test_curves_are_drawn_for_every_stage(rows):
    picture = pixels(draw_curves(rows, title="a run"))

    assert picture.shape[0] > 300
    assert picture.std() > 0.05


def test_curves_of_a_method_without_grids_have_no_coverage(rows):
    picture = pixels(draw_curves(rows, title="a run"))
    lower = pixels(draw_curves([replace(row, coverage=None) for row in rows], title="a run"))

    assert lower.shape[0] < picture.shape[0]
    assert lower.std() > 0.05


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


def test_a_grid_of_one_measure_is_drawn_as_a_row_of_objectives():
    grid = StoredGrid(
        spec=GridSpec(dims=(100,), ranges=((0.0, 2.0),)),
        cells=np.array([0, 40, 99]),
        elites=np.array([2, 0, 1]),
        measures=np.array([[0.01], [0.8], [2.0]]),
    )
    columns = {"success": np.array([True, False, True]), "objective": np.array([0.5, -1.0, 2.0])}

    few = pixels(draw_heat_map("ground_truth", grid, fields=columns))
    failed = columns | {"success": np.zeros(3, bool)}
    none = pixels(draw_heat_map("ground_truth", grid, fields=failed))

    assert few.shape == none.shape
    assert (few != none).any()


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
