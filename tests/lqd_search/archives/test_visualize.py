import matplotlib as mpl

mpl.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
import pytest
from ribs.visualize import grid_archive_heatmap, parallel_axes_plot

from lqd_search import GridSpec, MultiBDArchive


@pytest.fixture(scope="module")
def archive():
    archive = MultiBDArchive(descriptors={"flat": 2, "deep": 3}, solution_dim=3)
    archive.set_grid("flat", GridSpec(dims=(10, 10), ranges=((0.0, 1.0),) * 2))
    archive.set_grid("deep", GridSpec(dims=(5, 5, 5), ranges=((0.0, 1.0),) * 3))
    solutions = np.random.default_rng(0).random((200, 3))
    archive.add(
        solutions,
        solutions.sum(axis=1),
        np.concatenate([solutions[:, :2], solutions], axis=1),
        success=solutions[:, 0] > 0.5,
    )
    return archive


def test_pyribs_draws_a_heat_map_of_a_grid_of_two_measures(archive):
    grid = archive.grids["flat"]
    figure, axes = plt.subplots()

    grid_archive_heatmap(grid, ax=axes)

    drawn = axes.collections[0].get_array()
    assert np.ma.count(np.ma.masked_invalid(drawn)) == len(grid)
    plt.close(figure)


@pytest.mark.parametrize("name", ["flat", "deep"])
def test_pyribs_draws_parallel_axes_of_any_grid(archive, name):
    figure, axes = plt.subplots()

    parallel_axes_plot(archive.grids[name], ax=axes)

    lines = sum(len(each.lines) for each in figure.axes)
    collections = sum(len(each.collections) for each in figure.axes)
    assert lines + collections >= len(archive.grids[name])
    plt.close(figure)
